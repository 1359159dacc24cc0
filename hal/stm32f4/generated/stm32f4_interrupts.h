/// Interrupts of the STM32F4. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_INTERRUPTS_H
#define STM32F4_INTERRUPTS_H

#define ADC_INTERRUPT 18u
#define PVD_INTERRUPT 1u
#define USART1_INTERRUPT 37u
#define USART2_INTERRUPT 38u
#define USART3_INTERRUPT 39u

#endif
