// Start-up of an STM32F4 image: vectors, then what all images have in common (start.h). What is no
// interrupt of the image is a fault (fault.h), the clock security system's among them, and a supply
// that falls.
#include "fault.h"
#include "start.h"
#include "stm32f4_interrupts.h"
#include "vectors.h"

#include <stdint.h>

extern uint32_t stack_top[]; // placed by image.ld

void Reset_Handler(void);

#define EXCEPTIONS 15u
#define INTERRUPTS 97u // of the F446; the F405 has 82

// NOLINTBEGIN(bugprone-branch-clone)
__attribute__((section(".vectors"), used)) static const struct {
    const uint32_t *initial_sp;
    void (*reset)(void);
    void (*exceptions[EXCEPTIONS - 1u])(void);
    void (*interrupts[INTERRUPTS])(void);
} vectors = {
    stack_top,
    Reset_Handler,
    {fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler,
     fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler,
     fault_handler, fault_handler},
    {
        [PVD_INTERRUPT] = fault_handler,
        [ADC_INTERRUPT] = interrupt_current,
        [USART1_INTERRUPT] = interrupt_console,
        [USART2_INTERRUPT] = interrupt_console,
        [USART3_INTERRUPT] = interrupt_console,
    },
};
// NOLINTEND(bugprone-branch-clone)

void Reset_Handler(void) {
    start_image();
}
