/// Registers of the STM32F4's ADC_COMMON. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_ADC_COMMON_H
#define STM32F4_ADC_COMMON_H

#define ADC_COMMON_BASE 0x40012300u

#define ADC_COMMON_CCR 0x004u
#define ADC_COMMON_CCR_MULTI (0x1fu << 0)
#define ADC_COMMON_CCR_MULTI_AT 0u
#define ADC_COMMON_CCR_DELAY (0xfu << 8)
#define ADC_COMMON_CCR_DELAY_AT 8u
#define ADC_COMMON_CCR_DDS (0x1u << 13)
#define ADC_COMMON_CCR_DMA (0x3u << 14)
#define ADC_COMMON_CCR_DMA_AT 14u
#define ADC_COMMON_CCR_ADCPRE (0x3u << 16)
#define ADC_COMMON_CCR_ADCPRE_AT 16u
#define ADC_COMMON_CCR_VBATE (0x1u << 22)
#define ADC_COMMON_CCR_TSVREFE (0x1u << 23)

#endif
