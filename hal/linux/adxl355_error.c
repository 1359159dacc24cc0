#include "adxl355_error.h"

bool adxl355_explain(const part_problem_t *problem, uint32_t range_g, uint32_t rate_Hz,
                     linux_error_t *error) {
    const uint8_t *const bytes = problem->bytes;
    switch (problem->verdict) {
    case PART_NO_TRANSFER:
        return linux_fail(error, "ADXL355: the SPI transfer failed");
    case PART_NOT_THERE:
        return linux_fail(error,
                          "ADXL355: not there: its ids read %02x %02x %02x instead of ad 1d ed; "
                          "check wiring, chip select and clock",
                          bytes[0], bytes[1], bytes[2]);
    case PART_NO_RESET:
        return linux_fail(error,
                          "ADXL355: does not reset (shadow registers differ); power it off and on");
    case PART_NOT_STORED:
        return linux_fail(error, "ADXL355: register 0x%02x reads 0x%02x after 0x%02x was written",
                          bytes[0], bytes[2], bytes[1]);
    case PART_NO_RANGE:
        return linux_fail(error, "ADXL355: range %u g: one of 2, 4, 8", range_g);
    case PART_NO_RATE:
        return linux_fail(error, "ADXL355: rate %u Hz: one of 4000, 2000, 1000, 500", rate_Hz);
    case PART_WELL:
    default:
        return true;
    }
}
