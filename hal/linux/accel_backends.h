/// Accelerometers, and other sensors that are read like them, on Linux. Each opens, fills in a
/// handle and returns an object to close.
#ifndef ACCEL_BACKENDS_H
#define ACCEL_BACKENDS_H

#include "hal_linux.h"
#include "linux_error.h"

#include <stdint.h>

/// An IIO device through sysfs and its character device (Documentation/ABI/testing/sysfs-bus-iio).
typedef struct {
    const char *device;     ///< "iio:device0", or the device's name ("adxl355")
    bool use_buffer;        ///< true: /dev/iio:deviceN with all three axes; false: in_accel_?_raw
    const char *trigger;    ///< name of the trigger for the buffer; NULL: leave as it is
    const char *sysfs_root; ///< "/sys/bus/iio/devices"; tests put a folder here
    const char *dev_root;   ///< "/dev"
} accel_iio_options_t;

/// A sensor of one axis answers on all. With the buffer every read takes the newest scan and never
/// blocks; a single read makes the sensor convert, which takes its bus's time.
typedef struct accel_iio accel_iio_t;
accel_iio_t *accel_iio_open(const accel_iio_options_t *options, hal_accel_t *accel,
                            linux_error_t *error);
void accel_iio_close(accel_iio_t *self);

/// A channel of an IIO device, whatever it measures (a stroke, force or voltage on an ADC): single
/// reads of in_CHANNEL_raw through sysfs. Each makes the device convert and takes its bus's time.
typedef struct {
    const char *device;     ///< as above
    const char *channel;    ///< "voltage0"
    const char *sysfs_root; ///< as above
} sensor_iio_options_t;

/// It answers on all axes.
typedef struct sensor_iio sensor_iio_t;
sensor_iio_t *sensor_iio_open(const sensor_iio_options_t *options, hal_accel_t *sensor,
                              linux_error_t *error);
void sensor_iio_close(sensor_iio_t *self);

/// ADXL355 on spidev (20 bits, +-2, 4 or 8 g), reset and started by the opening. counts: 20 bits,
/// signed; 3.9, 7.8 or 15.6 ug each. A read is one SPI transfer of 14 bytes and true only where the
/// sensor says that its data are new. Untested on hardware.
typedef struct {
    const char *device; ///< "/dev/spidev0.0"
    uint32_t clock_Hz;  ///< at most 10 MHz
    uint32_t range_g;   ///< 2, 4 or 8
    uint32_t rate_Hz;   ///< 4000, 2000, 1000 or 500
} accel_adxl355_options_t;

typedef struct accel_adxl355 accel_adxl355_t;
accel_adxl355_t *accel_adxl355_open(const accel_adxl355_options_t *options, hal_accel_t *accel,
                                    linux_error_t *error);
void accel_adxl355_close(accel_adxl355_t *self);

/// Reads that failed since the opening, saturating; the program reports them.
uint32_t accel_iio_failures(const accel_iio_t *self);
uint32_t accel_adxl355_failures(const accel_adxl355_t *self);
uint32_t sensor_iio_failures(const sensor_iio_t *self);

#endif
