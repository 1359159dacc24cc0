/// Of a function that runs where a controller starts, or takes parameters or tables, and stands in
/// one file with what its tick calls: size counts there, not speed.
#ifndef AT_START_H
#define AT_START_H

#if defined(__GNUC__)
#define AT_START __attribute__((cold))
#else
#define AT_START
#endif

#endif
