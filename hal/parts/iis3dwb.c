#include "iis3dwb.h"

#include <string.h>

// Register map.
#define WHO_AM_I 0x0Fu
#define CTRL1_XL 0x10u
#define CTRL3_C 0x12u
#define CTRL8_XL 0x17u
#define STATUS_REG 0x1Eu
#define OUTX_L_A 0x28u

#define READ 0x80u
#define ID 0x7Bu
#define CTRL1_ON 0xA0u       // XL_EN
#define CTRL1_LOW_PASS 0x02u // LPF2_XL_EN
#define CTRL1_RANGE_AT 2u
#define CTRL3_RESET 0x01u
#define CTRL3_USE 0x44u      // BDU: a sample is one; IF_INC: addresses go on
#define CTRL8_OVER_100 0x80u // HPCF_XL: a hundredth of the rate
#define STATUS_DATA_READY 0x01u

#define OUT_BYTES 6u
#define RESET_MS 10u
#define START_MS 10u

static part_register_t at(uint8_t address) {
    return (part_register_t){address, (uint8_t)(address | READ), address};
}

static bool read_registers(const iis3dwb_t *self, uint8_t first, uint8_t *out, size_t count) {
    return part_read(&self->bus, at(first).read, out, count);
}

static bool write_register(const iis3dwb_t *self, uint8_t address, uint8_t value) {
    return part_write(&self->bus, at(address).write, value);
}

static bool set_register(const iis3dwb_t *self, uint8_t address, uint8_t value,
                         part_problem_t *problem) {
    return part_set(&self->bus, at(address), value, problem);
}

static bool check_part(const iis3dwb_t *self, part_problem_t *problem) {
    if (!read_registers(self, WHO_AM_I, problem->bytes, 1)) {
        return part_fail(problem, PART_NO_TRANSFER);
    }
    return problem->bytes[0] == ID || part_fail(problem, PART_NOT_THERE);
}

static bool reset(const iis3dwb_t *self, part_problem_t *problem) {
    uint8_t control;
    if (!write_register(self, CTRL3_C, CTRL3_RESET)) {
        return part_fail(problem, PART_NO_TRANSFER);
    }
    self->bus.pause_ms(self->bus.context, RESET_MS);
    if (!read_registers(self, CTRL3_C, &control, 1)) {
        return part_fail(problem, PART_NO_TRANSFER);
    }
    return (control & CTRL3_RESET) == 0u || part_fail(problem, PART_NO_RESET);
}

// In the order of FS_XL's codes.
static bool range_code(uint32_t range_g, uint8_t *code) {
    static const uint8_t ranges_g[] = {2, 16, 4, 8};
    for (size_t i = 0; i < sizeof ranges_g; i++) {
        if (ranges_g[i] == range_g) {
            *code = (uint8_t)i;
            return true;
        }
    }
    return false;
}

bool iis3dwb_start(iis3dwb_t *self, part_bus_t bus, uint32_t range_g, part_problem_t *problem) {
    uint8_t range = 0;
    *self = (iis3dwb_t){.bus = bus};
    problem->verdict = PART_WELL;
    if (!range_code(range_g, &range)) {
        return part_fail(problem, PART_NO_RANGE);
    }
    const uint8_t control =
        (uint8_t)(CTRL1_ON | CTRL1_LOW_PASS | (uint32_t)range << CTRL1_RANGE_AT);
    const bool is_well = check_part(self, problem) && reset(self, problem) &&
                         set_register(self, CTRL3_C, CTRL3_USE, problem) &&
                         set_register(self, CTRL8_XL, CTRL8_OVER_100, problem) &&
                         set_register(self, CTRL1_XL, control, problem);
    if (is_well) {
        bus.pause_ms(bus.context, START_MS);
    }
    return is_well;
}

static int32_t sample_of(const uint8_t *bytes) {
    const int32_t value = (int32_t)((uint32_t)bytes[1] << 8 | bytes[0]);
    return value >= 1 << 15 ? value - (1 << 16) : value;
}

static bool take(iis3dwb_t *self) {
    uint8_t status;
    uint8_t out[OUT_BYTES];
    if (!read_registers(self, STATUS_REG, &status, 1) ||
        ((status & STATUS_DATA_READY) != 0u && !read_registers(self, OUTX_L_A, out, OUT_BYTES))) {
        self->failures += self->failures < UINT32_MAX ? 1u : 0u;
        return false;
    }
    for (size_t i = 0; (status & STATUS_DATA_READY) != 0u && i < IIS3DWB_AXES; i++) {
        self->counts[i] = sample_of(&out[2u * i]);
        self->is_fresh[i] = true;
    }
    return true;
}

bool iis3dwb_read(iis3dwb_t *self, hal_axis_t axis, int32_t *counts) {
    if (!take(self) || !self->is_fresh[axis]) {
        return false;
    }
    self->is_fresh[axis] = false;
    *counts = self->counts[axis];
    return true;
}
