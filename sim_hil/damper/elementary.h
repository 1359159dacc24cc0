/// Elementary functions for a double or a Wide alike: the same operations, thus the same bits, in
/// every lane and on every machine. Relative error below 1e-10 in the ranges stated; no special
/// cases for infinities and NaN.
#ifndef QUIESCE_ELEMENTARY_H
#define QUIESCE_ELEMENTARY_H

#include "scalar_lane.h"

namespace quiesce {

template <class T>
T absolute(const T &x) {
    return from_bits(bits_of(x) & same_int(x, 0x7fffffffffffffff));
}

/// magnitude >= 0 with the sign of x (that of +0 is +).
template <class T>
T with_sign_of(const T &magnitude, const T &x) {
    return from_bits(bits_of(magnitude) |
                     (bits_of(x) & same_int(x, static_cast<std::int64_t>(1) << 63)));
}

template <class T>
T smaller(const T &a, const T &b) {
    return select(a < b, a, b);
}
template <class T>
T larger(const T &a, const T &b) {
    return select(a > b, a, b);
}
template <class T>
T clipped(const T &x, const T &low, const T &high) {
    return smaller(larger(x, low), high);
}

/// -1, 0 or 1.
template <class T>
T sign(const T &x) {
    return select(x > T(0.0), T(1.0), select(x < T(0.0), T(-1.0), T(0.0)));
}

/// Adding it rounds to an integer, which then stands in the low bits.
constexpr double kRounder = 6755399441055744.0; // 1.5 * 2^52

/// e^x; x is limited to +-700.
template <class T>
T exponential(const T &argument) {
    const T x = clipped(argument, T(-700.0), T(700.0));
    const T shifted = x * T(1.4426950408889634) + T(kRounder);
    const T k = shifted - T(kRounder);
    const T r = (x - k * T(6.93145751953125e-1)) - k * T(1.42860682030941723212e-6);
    // Taylor, in pairs so that the processor can overlap them: |r| <= 0.347, the next term is
    // 7e-12.
    const T r2 = r * r;
    const T r4 = r2 * r2;
    const T low = (T(1.0) + r) + r2 * (T(0.5) + T(1.0 / 6.0) * r);
    const T middle =
        (T(1.0 / 24.0) + T(1.0 / 120.0) * r) + r2 * (T(1.0 / 720.0) + T(1.0 / 5040.0) * r);
    const T sum = low + r4 * (middle + r4 * (T(1.0 / 40320.0) + T(1.0 / 362880.0) * r));
    return from_bits(bits_of(sum) + shift_left(bits_of(shifted), 52));
}

/// ln x for normal x > 0; about -708 for 0.
template <class T>
T logarithm(const T &x) {
    const auto bits = bits_of(x);
    // Exponent such that the mantissa lies in sqrt(1/2) .. sqrt(2).
    const auto exponent = shift_right(bits - same_int(x, 0x3fe6a09e667f3bcd), 52);
    const T m = from_bits(bits - shift_left(exponent, 52));
    const T e = from_bits(exponent + same_int(x, 0x4338000000000000)) - T(kRounder);
    const T s = (m - T(1.0)) / (m + T(1.0));
    const T s2 = s * s;
    // 2 artanh(s), in pairs: s^2 <= 0.0295, the next term is 5e-11.
    const T s4 = s2 * s2;
    const T low = (T(2.0) + T(2.0 / 3.0) * s2) + s4 * (T(2.0 / 5.0) + T(2.0 / 7.0) * s2);
    const T sum = low + (s4 * s4) * (T(2.0 / 9.0) + T(2.0 / 11.0) * s2);
    return e * T(0.69314718055994530942) + sum * s;
}

/// x^n for x >= 0 and n > 0.
template <class T>
T power(const T &x, const T &n) {
    return exponential(n * logarithm(x));
}

template <class T>
T hyperbolic_tangent(const T &x) {
    const T left = exponential(T(-2.0) * absolute(x));
    return with_sign_of((T(1.0) - left) / (T(1.0) + left), x);
}

template <class T>
T arctangent(const T &x) {
    // Twice halved: atan x = 2 atan(x / (1 + sqrt(1 + x^2))), then |u| <= 0.415 and below 0.2.
    const T once = x / (T(1.0) + square_root(T(1.0) + x * x));
    const T u = once / (T(1.0) + square_root(T(1.0) + once * once));
    const T u2 = u * u;
    T sum = T(-1.0 / 31.0);
    for (int k = 29; k >= 1; k -= 2) {
        sum = sum * u2 + T((k / 2 % 2 == 0 ? 1.0 : -1.0) / k);
    }
    return T(4.0) * u * sum;
}

/// sin x for |x| <= 1e5.
template <class T>
T sine(const T &x) {
    const T shifted = x * T(0.31830988618379067154) + T(kRounder);
    const T half_turns = shifted - T(kRounder);
    const T r =
        (x - half_turns * T(3.1415926218032836914)) - half_turns * T(3.1786509424591713469e-8);
    const T r2 = r * r;
    T sum = T(1.0 / 355687428096000.0);
    sum = sum * r2 - T(1.0 / 1307674368000.0);
    sum = sum * r2 + T(1.0 / 6227020800.0);
    sum = sum * r2 - T(1.0 / 39916800.0);
    sum = sum * r2 + T(1.0 / 362880.0);
    sum = sum * r2 - T(1.0 / 5040.0);
    sum = sum * r2 + T(1.0 / 120.0);
    sum = sum * r2 - T(1.0 / 6.0);
    sum = sum * r2 + T(1.0);
    const T value = r * sum;
    // An odd number of half turns changes the sign.
    return from_bits(bits_of(value) ^ shift_left(bits_of(shifted), 63));
}

} // namespace quiesce

#endif
