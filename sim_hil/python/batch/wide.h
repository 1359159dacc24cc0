/// Several candidates side by side: arithmetic on kLanes doubles at once, as many as suit the
/// processor.
///
/// The same source is compiled once for every instruction set (QUIESCE_ISA is the namespace, so
/// that nothing of one set is ever linked into another). There are no fused operations and no
/// library calls, so every lane has the same bits as a double, on every machine: a fit with a seed
/// is repeatable. That is why this is not a SIMD library.
#ifndef QUIESCE_WIDE_H
#define QUIESCE_WIDE_H

#include <cstddef>
#include <cstdint>

#ifndef QUIESCE_ISA
#define QUIESCE_ISA isa_base
#endif

namespace quiesce {
namespace QUIESCE_ISA {

#if defined(__AVX512F__)
constexpr int kPartBytes = 64;
#elif defined(__AVX__)
constexpr int kPartBytes = 32;
#else
constexpr int kPartBytes = 16;
#endif
/// Four parts: the operations of one fill the waiting times of the others.
constexpr int kParts = 4;
constexpr std::size_t kLanes = kParts * kPartBytes / 8;

// NOLINTNEXTLINE(modernize-use-using): the attribute needs it
typedef double DoublePart __attribute__((vector_size(kPartBytes)));
// NOLINTNEXTLINE(modernize-use-using)
typedef std::int64_t IntPart __attribute__((vector_size(kPartBytes)));

/// kLanes integers; as a mask, a lane is all ones or all zeros.
struct WideInt {
    IntPart part[kParts];
};

struct Wide {
    DoublePart part[kParts];

    Wide() = default;
    // NOLINTNEXTLINE(google-explicit-constructor): numbers mix with lanes as with doubles
    Wide(double value) {
        for (DoublePart &one : part) {
            one = value - DoublePart{};
        }
    }
};

#define QUIESCE_WIDE_BINARY(op)                                                                    \
    inline Wide operator op(const Wide &a, const Wide &b) {                                        \
        Wide out;                                                                                  \
        for (int k = 0; k < kParts; ++k) {                                                         \
            out.part[k] = a.part[k] op b.part[k];                                                  \
        }                                                                                          \
        return out;                                                                                \
    }
QUIESCE_WIDE_BINARY(+)
QUIESCE_WIDE_BINARY(-)
QUIESCE_WIDE_BINARY(*)
QUIESCE_WIDE_BINARY(/)
#undef QUIESCE_WIDE_BINARY

#define QUIESCE_WIDE_COMPARE(op)                                                                   \
    inline WideInt operator op(const Wide &a, const Wide &b) {                                     \
        WideInt out;                                                                               \
        for (int k = 0; k < kParts; ++k) {                                                         \
            out.part[k] = (IntPart)(a.part[k] op b.part[k]);                                       \
        }                                                                                          \
        return out;                                                                                \
    }
QUIESCE_WIDE_COMPARE(<)
QUIESCE_WIDE_COMPARE(>)
QUIESCE_WIDE_COMPARE(<=)
QUIESCE_WIDE_COMPARE(>=)
#undef QUIESCE_WIDE_COMPARE

inline Wide operator-(const Wide &a) {
    Wide out;
    for (int k = 0; k < kParts; ++k) {
        out.part[k] = -a.part[k];
    }
    return out;
}

#define QUIESCE_WIDE_INT(op)                                                                       \
    inline WideInt operator op(const WideInt &a, const WideInt &b) {                               \
        WideInt out;                                                                               \
        for (int k = 0; k < kParts; ++k) {                                                         \
            out.part[k] = a.part[k] op b.part[k];                                                  \
        }                                                                                          \
        return out;                                                                                \
    }
QUIESCE_WIDE_INT(+)
QUIESCE_WIDE_INT(-)
QUIESCE_WIDE_INT(&)
QUIESCE_WIDE_INT(|)
QUIESCE_WIDE_INT(^)
#undef QUIESCE_WIDE_INT

inline WideInt shift_left(const WideInt &a, int bits) {
    WideInt out;
    for (int k = 0; k < kParts; ++k) {
        out.part[k] = a.part[k] << bits;
    }
    return out;
}

/// Arithmetic: the sign is kept.
inline WideInt shift_right(const WideInt &a, int bits) {
    WideInt out;
    for (int k = 0; k < kParts; ++k) {
        out.part[k] = a.part[k] >> bits;
    }
    return out;
}

inline WideInt bits_of(const Wide &a) {
    WideInt out;
    for (int k = 0; k < kParts; ++k) {
        out.part[k] = (IntPart)a.part[k];
    }
    return out;
}

inline Wide from_bits(const WideInt &a) {
    Wide out;
    for (int k = 0; k < kParts; ++k) {
        out.part[k] = (DoublePart)a.part[k];
    }
    return out;
}

inline WideInt same_int(const Wide & /*like*/, std::int64_t value) {
    WideInt out;
    for (IntPart &one : out.part) {
        one = value - IntPart{};
    }
    return out;
}

/// a where the mask is set, else b.
inline Wide select(const WideInt &mask, const Wide &a, const Wide &b) {
    Wide out;
    for (int k = 0; k < kParts; ++k) {
        out.part[k] = mask.part[k] ? a.part[k] : b.part[k];
    }
    return out;
}

inline Wide square_root(const Wide &a) {
    Wide out;
    for (int k = 0; k < kParts; ++k) {
        for (int lane = 0; lane < kPartBytes / 8; ++lane) {
            out.part[k][lane] = __builtin_sqrt(a.part[k][lane]);
        }
    }
    return out;
}

} // namespace QUIESCE_ISA
} // namespace quiesce

#endif
