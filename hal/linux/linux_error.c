#include "linux_error.h"

#include <stdarg.h>
#include <stdio.h>

bool linux_fail(linux_error_t *error, const char *format, ...) {
    if (error != NULL) {
        va_list arguments;
        va_start(arguments, format);
        (void)vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
    }
    return false;
}
