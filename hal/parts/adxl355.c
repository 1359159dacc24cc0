#include "adxl355.h"

#include <string.h>

// Register map.
#define DEVID_AD 0x00u // 0xAD, then 0x1D (MEMS) and 0xED (ADXL355)
#define STATUS 0x04u   // then FIFO_ENTRIES, TEMP2, TEMP1, XDATA3 .. ZDATA1
#define FILTER 0x28u
#define RANGE 0x2Cu
#define POWER_CTL 0x2Du
#define RESET 0x2Fu
#define SHADOW 0x50u

#define STATUS_DATA_RDY 0x01u
#define RANGE_RESET 0x81u // I2C high speed, +-2 g: what a reset leaves
#define RANGE_MASK 0x03u
#define POWER_MEASURE 0x00u
#define POWER_STANDBY 0x01u
#define RESET_CODE 0x52u

#define IDS 3u
#define SHADOWS 5u
#define DATA_AT 4u // XDATA3 after STATUS
#define RESETS_AT_MOST 3
#define RESET_MS 10u

/// A command byte is the address and, in bit 0, whether it reads.
static part_register_t at(uint8_t address) {
    return (part_register_t){address, (uint8_t)((unsigned int)address << 1 | 1u),
                             (uint8_t)(address << 1)};
}

static bool read_registers(const adxl355_t *self, uint8_t first, uint8_t *out, size_t count) {
    return part_read(&self->bus, at(first).read, out, count);
}

static bool write_register(const adxl355_t *self, uint8_t address, uint8_t value) {
    return part_write(&self->bus, at(address).write, value);
}

static bool set_register(const adxl355_t *self, uint8_t address, uint8_t value,
                         part_problem_t *problem) {
    return part_set(&self->bus, at(address), value, problem);
}

static bool check_part(const adxl355_t *self, part_problem_t *problem) {
    static const uint8_t expected[IDS] = {0xAD, 0x1D, 0xED};
    if (!read_registers(self, DEVID_AD, problem->bytes, IDS)) {
        return part_fail(problem, PART_NO_TRANSFER);
    }
    return memcmp(problem->bytes, expected, IDS) == 0 || part_fail(problem, PART_NOT_THERE);
}

// A reset may load trimming values wrongly, says the data sheet: compare the shadow registers with
// those before it, and reset again.
static bool reset(const adxl355_t *self, part_problem_t *problem) {
    uint8_t before[SHADOWS];
    uint8_t after[SHADOWS];
    if (!read_registers(self, SHADOW, before, SHADOWS)) {
        return part_fail(problem, PART_NO_TRANSFER);
    }
    for (int i = 0; i < RESETS_AT_MOST; i++) {
        if (!write_register(self, RESET, RESET_CODE)) {
            return part_fail(problem, PART_NO_TRANSFER);
        }
        self->bus.pause_ms(self->bus.context, RESET_MS);
        if (!read_registers(self, SHADOW, after, SHADOWS)) {
            return part_fail(problem, PART_NO_TRANSFER);
        }
        if (memcmp(before, after, SHADOWS) == 0) {
            return true;
        }
    }
    return part_fail(problem, PART_NO_RESET);
}

/// FILTER: no high-pass, output data rate 4000 Hz / 2^code.
static bool filter_code(uint32_t rate_Hz, uint8_t *code) {
    for (uint8_t i = 0; i < 4u; i++) {
        if (4000u >> i == rate_Hz) {
            *code = i;
            return true;
        }
    }
    return false;
}

static bool range_code(uint32_t range_g, uint8_t *code) {
    *code = range_g == 2u ? 1u : range_g == 4u ? 2u : 3u;
    return range_g == 2u || range_g == 4u || range_g == 8u;
}

// Settings are for standby, says the data sheet.
bool adxl355_set_rate(adxl355_t *self, uint32_t rate_Hz, part_problem_t *problem) {
    uint8_t filter = 0;
    problem->verdict = PART_WELL;
    if (!filter_code(rate_Hz, &filter)) {
        return part_fail(problem, PART_NO_RATE);
    }
    memset(self->is_fresh, 0, sizeof self->is_fresh); // of the old rate
    return set_register(self, POWER_CTL, POWER_STANDBY, problem) &&
           set_register(self, FILTER, filter, problem) &&
           set_register(self, POWER_CTL, POWER_MEASURE, problem);
}

bool adxl355_start(adxl355_t *self, part_bus_t bus, uint32_t range_g, uint32_t rate_Hz,
                   part_problem_t *problem) {
    uint8_t range = 0;
    uint8_t filter = 0;
    *self = (adxl355_t){.bus = bus};
    problem->verdict = PART_WELL;
    if (!range_code(range_g, &range)) {
        return part_fail(problem, PART_NO_RANGE);
    }
    if (!filter_code(rate_Hz, &filter)) {
        return part_fail(problem, PART_NO_RATE);
    }
    const uint8_t range_register = (uint8_t)((RANGE_RESET & ~RANGE_MASK) | range);
    return check_part(self, problem) && reset(self, problem) &&
           set_register(self, RANGE, range_register, problem) &&
           adxl355_set_rate(self, rate_Hz, problem);
}

/// 20 bits, left-justified in three bytes, most significant first.
static int32_t sample_of(const uint8_t *bytes) {
    const int32_t value =
        (int32_t)((uint32_t)bytes[0] << 12 | (uint32_t)bytes[1] << 4 | (uint32_t)bytes[2] >> 4);
    return value >= 1 << 19 ? value - (1 << 20) : value;
}

bool adxl355_read(adxl355_t *self, hal_axis_t axis, int32_t *counts) {
    uint8_t registers[ADXL355_MAX_TRANSFER - 1u];
    if (!read_registers(self, STATUS, registers, sizeof registers)) {
        self->failures += self->failures < UINT32_MAX ? 1u : 0u;
        return false;
    }
    if ((registers[0] & STATUS_DATA_RDY) != 0u) {
        for (int i = 0; i < ADXL355_AXES; i++) {
            self->counts[i] = sample_of(&registers[DATA_AT + 3u * (size_t)i]);
            self->is_fresh[i] = true;
        }
    }
    if (!self->is_fresh[axis]) {
        return false;
    }
    self->is_fresh[axis] = false;
    *counts = self->counts[axis];
    return true;
}

bool adxl355_stop(adxl355_t *self) {
    return write_register(self, POWER_CTL, POWER_STANDBY);
}
