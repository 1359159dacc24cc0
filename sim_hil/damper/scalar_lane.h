/// A double with the few operations that a Wide has beyond operators, so that one template serves
/// both (elementary.h, the kernels).
#ifndef QUIESCE_SCALAR_LANE_H
#define QUIESCE_SCALAR_LANE_H

#include <cmath>
#include <cstdint>
#include <cstring>

namespace quiesce {

inline std::int64_t bits_of(double a) {
    std::int64_t bits = 0;
    std::memcpy(&bits, &a, sizeof bits);
    return bits;
}

inline double from_bits(std::int64_t bits) {
    double a = 0.0;
    std::memcpy(&a, &bits, sizeof a);
    return a;
}

inline std::int64_t same_int(double /*like*/, std::int64_t value) {
    return value;
}

inline std::int64_t shift_left(std::int64_t a, int bits) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) << bits);
}

/// Arithmetic: the sign is kept.
inline std::int64_t shift_right(std::int64_t a, int bits) {
    return a >> bits;
}

inline double select(bool condition, double a, double b) {
    return condition ? a : b;
}

inline double square_root(double a) {
    return std::sqrt(a);
}

} // namespace quiesce

#endif
