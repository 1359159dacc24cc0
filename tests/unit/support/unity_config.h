/// Unity's configuration for all builds: integers only; an image's output goes by semihosting.
#ifndef UNITY_CONFIG_H
#define UNITY_CONFIG_H

#define UNITY_EXCLUDE_FLOAT
#define UNITY_EXCLUDE_DOUBLE
#define UNITY_EXCLUDE_MATH_H

#ifdef QUIESCE_TARGET_IMAGE
#include "semihost.h"
#define UNITY_OUTPUT_CHAR(c) semihost_put_char((char)(c))
#endif

#endif
