// The peer of the fuzzy engine: libfuzzylite on the reference controller, in single precision on
// the FPU, each evaluation bracketed for the instruction counter.
#include <cstdint>
#include <memory>
#include <string>

#include <fl/Headers.h>

extern "C" {
#include "counted_call.h"
#include "mailbox.h"
#include "print.h"
#include "stack.h"
}

#include "fuzzy_reference_fll.h"

namespace {

/// What the run is to be; the emulator puts it where the mailbox is otherwise.
struct Order {
    std::uint32_t evaluations;
    std::uint32_t resolution; ///< samples of the centroid; 0: the singletons
    std::uint32_t seed;
};

fl::Engine *engine;
float inputs[2];
float output;

void evaluate() {
    engine->inputVariables()[0]->setValue(inputs[0]);
    engine->inputVariables()[1]->setValue(inputs[1]);
    engine->process();
    output = engine->outputVariables()[0]->getValue();
}

std::unique_ptr<fl::Engine> make_engine(std::uint32_t resolution) {
    const char *text = resolution == 0 ? kReferenceSingletonFll : kReferenceCentroidFll;
    std::unique_ptr<fl::Engine> made(fl::FllImporter().fromString(text));
    auto *centroid =
        dynamic_cast<fl::IntegralDefuzzifier *>(made->outputVariables()[0]->getDefuzzifier());
    if (centroid != nullptr) {
        centroid->setResolution(static_cast<int>(resolution));
    }
    return made;
}

/// Even over the variable's universe.
float next_value(std::uint32_t &seed, const fl::Variable &variable) {
    seed = seed * 1664525u + 1013904223u;
    const float share = static_cast<float>(seed >> 16) / 65535.0f;
    return variable.getMinimum() + share * (variable.getMaximum() - variable.getMinimum());
}

// Apart from main, whose first instructions must not need the FPU.
__attribute__((noinline)) int run(const Order &order) {
    std::uint32_t seed = order.seed;
    float sum = 0.0f;
    const auto made = make_engine(order.resolution);
    engine = made.get();
    counted_call_init();
    for (std::uint32_t i = 0; i < order.evaluations; i++) {
        inputs[0] = next_value(seed, *engine->inputVariables()[0]);
        inputs[1] = next_value(seed, *engine->inputVariables()[1]);
        counted_call(evaluate, 0, 0, 0);
        sum += output;
    }
    print("mean_uA",
          static_cast<std::uint32_t>(1e6f * sum / static_cast<float>(order.evaluations)));
    print("stack_bytes", counted_call_stack_bytes());
    return counted_call_stack_bytes() < counted_call_stack_size_bytes() ? 0 : 1;
}

} // namespace

extern "C" {
extern void (*init_array_begin[])();
extern void (*init_array_end[])();
void *__dso_handle = nullptr;
void _fini() {}
}

int main() {
    *reinterpret_cast<volatile std::uint32_t *>(0xE000ED88u) |= 0xFu << 20; // the FPU: CPACR
    asm volatile("dsb\nisb");
    for (auto function = init_array_begin; function < init_array_end; function++) {
        (*function)();
    }
    const Order order = *reinterpret_cast<const Order *>(MAILBOX_BASE);
    return run(order);
}
