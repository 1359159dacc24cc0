/// Registers of the STM32F4's ADC. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_ADC_H
#define STM32F4_ADC_H

#define ADC1_BASE 0x40012000u

#define ADC_SR 0x000u
#define ADC_SR_AWD (0x1u << 0)
#define ADC_SR_EOC (0x1u << 1)
#define ADC_SR_JEOC (0x1u << 2)
#define ADC_SR_JSTRT (0x1u << 3)
#define ADC_SR_STRT (0x1u << 4)
#define ADC_SR_OVR (0x1u << 5)

#define ADC_CR1 0x004u
#define ADC_CR1_AWDCH (0x1fu << 0)
#define ADC_CR1_AWDCH_AT 0u
#define ADC_CR1_EOCIE (0x1u << 5)
#define ADC_CR1_AWDIE (0x1u << 6)
#define ADC_CR1_JEOCIE (0x1u << 7)
#define ADC_CR1_SCAN (0x1u << 8)
#define ADC_CR1_AWDSGL (0x1u << 9)
#define ADC_CR1_JAUTO (0x1u << 10)
#define ADC_CR1_DISCEN (0x1u << 11)
#define ADC_CR1_JDISCEN (0x1u << 12)
#define ADC_CR1_DISCNUM (0x7u << 13)
#define ADC_CR1_DISCNUM_AT 13u
#define ADC_CR1_JAWDEN (0x1u << 22)
#define ADC_CR1_AWDEN (0x1u << 23)
#define ADC_CR1_RES (0x3u << 24)
#define ADC_CR1_RES_AT 24u
#define ADC_CR1_OVRIE (0x1u << 26)

#define ADC_CR2 0x008u
#define ADC_CR2_ADON (0x1u << 0)
#define ADC_CR2_CONT (0x1u << 1)
#define ADC_CR2_DMA (0x1u << 8)
#define ADC_CR2_DDS (0x1u << 9)
#define ADC_CR2_EOCS (0x1u << 10)
#define ADC_CR2_ALIGN (0x1u << 11)
#define ADC_CR2_JEXTSEL (0xfu << 16)
#define ADC_CR2_JEXTSEL_AT 16u
#define ADC_CR2_JEXTEN (0x3u << 20)
#define ADC_CR2_JEXTEN_AT 20u
#define ADC_CR2_JSWSTART (0x1u << 22)
#define ADC_CR2_EXTSEL (0xfu << 24)
#define ADC_CR2_EXTSEL_AT 24u
#define ADC_CR2_EXTEN (0x3u << 28)
#define ADC_CR2_EXTEN_AT 28u
#define ADC_CR2_SWSTART (0x1u << 30)

#define ADC_SMPR1 0x00cu
#define ADC_SMPR1_SMP10 (0x7u << 0)
#define ADC_SMPR1_SMP10_AT 0u
#define ADC_SMPR1_SMP11 (0x7u << 3)
#define ADC_SMPR1_SMP11_AT 3u
#define ADC_SMPR1_SMP12 (0x7u << 6)
#define ADC_SMPR1_SMP12_AT 6u
#define ADC_SMPR1_SMP13 (0x7u << 9)
#define ADC_SMPR1_SMP13_AT 9u
#define ADC_SMPR1_SMP14 (0x7u << 12)
#define ADC_SMPR1_SMP14_AT 12u
#define ADC_SMPR1_SMP15 (0x7u << 15)
#define ADC_SMPR1_SMP15_AT 15u
#define ADC_SMPR1_SMP16 (0x7u << 18)
#define ADC_SMPR1_SMP16_AT 18u
#define ADC_SMPR1_SMP17 (0x7u << 21)
#define ADC_SMPR1_SMP17_AT 21u
#define ADC_SMPR1_SMP18 (0x7u << 24)
#define ADC_SMPR1_SMP18_AT 24u

#define ADC_SMPR2 0x010u
#define ADC_SMPR2_SMP0 (0x7u << 0)
#define ADC_SMPR2_SMP0_AT 0u
#define ADC_SMPR2_SMP1 (0x7u << 3)
#define ADC_SMPR2_SMP1_AT 3u
#define ADC_SMPR2_SMP2 (0x7u << 6)
#define ADC_SMPR2_SMP2_AT 6u
#define ADC_SMPR2_SMP3 (0x7u << 9)
#define ADC_SMPR2_SMP3_AT 9u
#define ADC_SMPR2_SMP4 (0x7u << 12)
#define ADC_SMPR2_SMP4_AT 12u
#define ADC_SMPR2_SMP5 (0x7u << 15)
#define ADC_SMPR2_SMP5_AT 15u
#define ADC_SMPR2_SMP6 (0x7u << 18)
#define ADC_SMPR2_SMP6_AT 18u
#define ADC_SMPR2_SMP7 (0x7u << 21)
#define ADC_SMPR2_SMP7_AT 21u
#define ADC_SMPR2_SMP8 (0x7u << 24)
#define ADC_SMPR2_SMP8_AT 24u
#define ADC_SMPR2_SMP9 (0x7u << 27)
#define ADC_SMPR2_SMP9_AT 27u

#define ADC_JSQR 0x038u
#define ADC_JSQR_JSQ1 (0x1fu << 0)
#define ADC_JSQR_JSQ1_AT 0u
#define ADC_JSQR_JSQ2 (0x1fu << 5)
#define ADC_JSQR_JSQ2_AT 5u
#define ADC_JSQR_JSQ3 (0x1fu << 10)
#define ADC_JSQR_JSQ3_AT 10u
#define ADC_JSQR_JSQ4 (0x1fu << 15)
#define ADC_JSQR_JSQ4_AT 15u
#define ADC_JSQR_JL (0x3u << 20)
#define ADC_JSQR_JL_AT 20u

#define ADC_JDR1 0x03cu
#define ADC_JDR1_JDATA (0xffffu << 0)
#define ADC_JDR1_JDATA_AT 0u

#define ADC_JDR2 0x040u
#define ADC_JDR2_JDATA (0xffffu << 0)
#define ADC_JDR2_JDATA_AT 0u

#endif
