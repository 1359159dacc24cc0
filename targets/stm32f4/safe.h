/// The safe state of the board's own outputs: nothing is driven. First of all at the start, and in
/// a fault of the processor, where nothing else runs any more.
#ifndef SAFE_H
#define SAFE_H

void safe_outputs(void);

#endif
