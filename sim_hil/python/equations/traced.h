/// A number that remembers how it was computed. A kernel that runs on these instead of doubles
/// leaves its equations behind, as a graph: what exports in other languages are written from.
///
/// The functions of elementary.h are single nodes here. Their own text is found by calling the
/// template: exponential<Traced>(x).
#ifndef QUIESCE_TRACED_H
#define QUIESCE_TRACED_H

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "elementary.h"

namespace quiesce {

struct TraceNode;
using TraceRef = std::shared_ptr<const TraceNode>;

/// what: "number", "integer", "name", or an operation on `from`: + - * / negative, < > <= >=,
/// select, bits, from_bits, bits+ bits- & | ^, << >> (by `integer`), or a function's name.
struct TraceNode {
    std::string what;
    std::vector<TraceRef> from;
    double number = 0.0;
    std::int64_t integer = 0;
    std::string name;
};

inline TraceRef trace_of(const char *what, std::vector<TraceRef> from, std::int64_t integer = 0) {
    return std::make_shared<const TraceNode>(TraceNode{what, std::move(from), 0.0, integer, {}});
}

struct Traced {
    TraceRef node;

    Traced() = default;
    explicit Traced(TraceRef made) : node(std::move(made)) {}
    // NOLINTNEXTLINE(google-explicit-constructor): numbers mix with traced ones as with doubles
    Traced(double value)
        : node(std::make_shared<const TraceNode>(TraceNode{"number", {}, value, 0, {}})) {}
};

/// The bits of a number, and what a comparison gives.
struct TracedInt {
    TraceRef node;
};
struct TracedBool {
    TraceRef node;
};

inline Traced traced_name(const std::string &name) {
    return Traced(std::make_shared<const TraceNode>(TraceNode{"name", {}, 0.0, 0, name}));
}

// NOLINTBEGIN(bugprone-macro-parentheses): a type takes none
#define QUIESCE_TRACED_BINARY(Type, Operand, op, what)                                             \
    inline Type operator op(const Operand &a, const Operand &b) {                                  \
        return Type{trace_of(what, {a.node, b.node})};                                             \
    }
// NOLINTEND(bugprone-macro-parentheses)
QUIESCE_TRACED_BINARY(Traced, Traced, +, "+")
QUIESCE_TRACED_BINARY(Traced, Traced, -, "-")
QUIESCE_TRACED_BINARY(Traced, Traced, *, "*")
QUIESCE_TRACED_BINARY(Traced, Traced, /, "/")
QUIESCE_TRACED_BINARY(TracedBool, Traced, <, "<")
QUIESCE_TRACED_BINARY(TracedBool, Traced, >, ">")
QUIESCE_TRACED_BINARY(TracedBool, Traced, <=, "<=")
QUIESCE_TRACED_BINARY(TracedBool, Traced, >=, ">=")
QUIESCE_TRACED_BINARY(TracedInt, TracedInt, +, "bits+")
QUIESCE_TRACED_BINARY(TracedInt, TracedInt, -, "bits-")
QUIESCE_TRACED_BINARY(TracedInt, TracedInt, &, "&")
QUIESCE_TRACED_BINARY(TracedInt, TracedInt, |, "|")
QUIESCE_TRACED_BINARY(TracedInt, TracedInt, ^, "^")
#undef QUIESCE_TRACED_BINARY

inline Traced operator-(const Traced &a) {
    return Traced(trace_of("negative", {a.node}));
}
inline TracedInt bits_of(const Traced &a) {
    return {trace_of("bits", {a.node})};
}
inline Traced from_bits(const TracedInt &a) {
    return Traced(trace_of("from_bits", {a.node}));
}
inline TracedInt same_int(const Traced & /*like*/, std::int64_t value) {
    return {trace_of("integer", {}, value)};
}
inline TracedInt shift_left(const TracedInt &a, int bits) {
    return {trace_of("<<", {a.node}, bits)};
}
inline TracedInt shift_right(const TracedInt &a, int bits) {
    return {trace_of(">>", {a.node}, bits)};
}
inline Traced select(const TracedBool &condition, const Traced &a, const Traced &b) {
    return Traced(trace_of("select", {condition.node, a.node, b.node}));
}
inline Traced square_root(const Traced &a) {
    return Traced(trace_of("square_root", {a.node}));
}

/// name, and the numbers that it takes.
#define QUIESCE_TRACED_FUNCTIONS(ONE, TWO, THREE)                                                  \
    ONE(absolute)                                                                                  \
    TWO(with_sign_of)                                                                              \
    TWO(smaller)                                                                                   \
    TWO(larger)                                                                                    \
    THREE(clipped)                                                                                 \
    ONE(sign)                                                                                      \
    ONE(exponential)                                                                               \
    ONE(logarithm)                                                                                 \
    TWO(power)                                                                                     \
    ONE(hyperbolic_tangent)                                                                        \
    ONE(arctangent)                                                                                \
    ONE(sine)

#define QUIESCE_TRACED_ONE(name)                                                                   \
    inline Traced name(const Traced &a) {                                                          \
        return Traced(trace_of(#name, {a.node}));                                                  \
    }
#define QUIESCE_TRACED_TWO(name)                                                                   \
    inline Traced name(const Traced &a, const Traced &b) {                                         \
        return Traced(trace_of(#name, {a.node, b.node}));                                          \
    }
#define QUIESCE_TRACED_THREE(name)                                                                 \
    inline Traced name(const Traced &a, const Traced &b, const Traced &c) {                        \
        return Traced(trace_of(#name, {a.node, b.node, c.node}));                                  \
    }
QUIESCE_TRACED_FUNCTIONS(QUIESCE_TRACED_ONE, QUIESCE_TRACED_TWO, QUIESCE_TRACED_THREE)
#undef QUIESCE_TRACED_ONE
#undef QUIESCE_TRACED_TWO
#undef QUIESCE_TRACED_THREE

} // namespace quiesce

#endif
