/// An error for the user is one line that names what is wrong.
#ifndef ONE_LINE_H
#define ONE_LINE_H

#include "linux_error.h"
#include "unity.h"

#include <string.h>

static inline void assert_one_line(const linux_error_t *error, const char *part) {
    TEST_ASSERT_NOT_EQUAL_MESSAGE(0, strlen(error->text), "no error was given");
    TEST_ASSERT_NULL_MESSAGE(strchr(error->text, '\n'), error->text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error->text, part), error->text);
}

#endif
