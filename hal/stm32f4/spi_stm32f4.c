#include "spi_stm32f4.h"

#include "reg.h"
#include "stm32f4_rcc.h"
#include "stm32f4_spi.h"

#define SPI_FUNCTION 5u        // alternate function of SPI1's and SPI2's pins
#define MOST_CLOCK_Hz 8000000u // of the ADXL355 10 MHz, of the IIS3DWB 10 MHz
#define MOST_DIVIDER 7u        // over 256

#define FIRST_RATE_Hz 1000u // of the ADXL355

/// A byte takes 12 us at the slowest clock that is made: more polls than that.
#define BYTE_POLLS 5000u
/// A pause's loop takes three cycles and more.
#define PAUSE_CYCLES 3u

static uint32_t core_rate_Hz; // of the pauses

static void pause_ms(void *context, uint32_t ms) {
    (void)context;
    for (volatile uint32_t i = 0; i < core_rate_Hz / 1000u / PAUSE_CYCLES * ms; i++) {
    }
}

static bool exchange_byte(uint32_t spi, uint8_t out, uint8_t *in) {
    if (!reg_wait(spi + SPI_SR, SPI_SR_TXE, SPI_SR_TXE, BYTE_POLLS)) {
        return false;
    }
    reg_write(spi + SPI_DR, out);
    if (!reg_wait(spi + SPI_SR, SPI_SR_RXNE, SPI_SR_RXNE, BYTE_POLLS)) {
        return false;
    }
    *in = (uint8_t)reg_read(spi + SPI_DR);
    return true;
}

static bool exchange(void *context, const uint8_t *out, uint8_t *in, size_t bytes) {
    const accel_wiring_t *const wiring = context;
    bool is_well = true;
    pin_write(wiring->select, false);
    for (size_t i = 0; i < bytes && is_well; i++) {
        is_well = exchange_byte(wiring->spi, out[i], &in[i]);
    }
    is_well = reg_wait(wiring->spi + SPI_SR, SPI_SR_BSY, 0, BYTE_POLLS) && is_well;
    pin_write(wiring->select, true);
    return is_well;
}

static void open_spi(const accel_wiring_t *wiring, uint32_t bus_Hz) {
    uint32_t divider = 0; // over 2
    while (bus_Hz >> (divider + 1u) > MOST_CLOCK_Hz && divider < MOST_DIVIDER) {
        divider++;
    }
    if (wiring->spi == SPI1_BASE) {
        reg_set(RCC_BASE + RCC_APB2ENR, RCC_APB2ENR_SPI1EN);
    } else {
        reg_set(RCC_BASE + RCC_APB1ENR, RCC_APB1ENR_SPI2EN);
    }
    pin_output(wiring->select, true);
    pin_function(wiring->sck, SPI_FUNCTION, PIN_FLOATS);
    pin_function(wiring->mosi, SPI_FUNCTION, PIN_FLOATS);
    pin_function(wiring->miso, SPI_FUNCTION, PIN_DOWN); // nothing there reads 0
    pin_input(wiring->drdy, PIN_DOWN);
    reg_write(wiring->spi + SPI_CR1,
              SPI_CR1_MSTR | SPI_CR1_SSM | SPI_CR1_SSI | divider << SPI_CR1_BR_AT);
    reg_set(wiring->spi + SPI_CR1, SPI_CR1_SPE);
}

bool accel_stm32f4_open(hal_accel_t *accel, const accel_wiring_t *wiring, uint32_t bus_Hz,
                        uint32_t core_Hz) {
    *accel = (hal_accel_t){.wiring = *wiring};
    const part_bus_t bus = {.exchange = exchange, .pause_ms = pause_ms, .context = &accel->wiring};
    core_rate_Hz = core_Hz;
    switch (wiring->part) {
    case ACCEL_ADXL355:
        open_spi(wiring, bus_Hz);
        accel->is_started =
            adxl355_start(&accel->adxl355, bus, wiring->range_g, FIRST_RATE_Hz, &accel->problem);
        accel->is_adxl355 = accel->is_started;
        accel->rate_Hz = FIRST_RATE_Hz;
        break;
    case ACCEL_IIS3DWB:
        open_spi(wiring, bus_Hz);
        accel->is_started = iis3dwb_start(&accel->iis3dwb, bus, wiring->range_g, &accel->problem);
        break;
    case ACCEL_NONE:
    default:
        break;
    }
    return accel->is_started;
}

bool accel_stm32f4_set_rate(hal_accel_t *accel, uint32_t rate_Hz) {
    if (accel->is_adxl355 && (rate_Hz != accel->rate_Hz || !accel->is_started)) {
        accel->rate_Hz = rate_Hz;
        accel->is_started = adxl355_set_rate(&accel->adxl355, rate_Hz, &accel->problem);
    }
    return accel->is_started;
}

bool hal_accel_read(hal_accel_t *accel, hal_axis_t axis, int32_t *counts) {
    if (!accel->is_started) {
        return false;
    }
    if (accel->wiring.part == ACCEL_IIS3DWB) {
        return iis3dwb_read(&accel->iis3dwb, axis, counts);
    }
    const bool may_wait = accel->adxl355.is_fresh[axis] || accel->wiring.drdy == PIN_NONE;
    return (may_wait || pin_read(accel->wiring.drdy)) &&
           adxl355_read(&accel->adxl355, axis, counts);
}
