/// What the command that packs an FMU asks the library: the variables of a folder of resources.
#ifndef QUIESCE_FMU_DESCRIBE_H
#define QUIESCE_FMU_DESCRIBE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A JSON object: tick_s, and variables in the order of their value references. NULL, with a line
/// in error, where the resources are refused. The text is to be freed.
const char *quiesce_fmu_describe(const char *resources, char *error, size_t error_size);
void quiesce_fmu_free(const char *text);

#ifdef __cplusplus
}
#endif

#endif
