/// Registers of the STM32F4's DAC. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_DAC_H
#define STM32F4_DAC_H

#define DAC_BASE 0x40007400u

#define DAC_CR 0x000u
#define DAC_CR_EN1 (0x1u << 0)
#define DAC_CR_EN2 (0x1u << 16)
#define DAC_CR_BOFF1 (0x1u << 1)
#define DAC_CR_BOFF2 (0x1u << 17)
#define DAC_CR_TEN1 (0x1u << 2)
#define DAC_CR_TEN2 (0x1u << 18)
#define DAC_CR_TSEL1 (0x7u << 3)
#define DAC_CR_TSEL1_AT 3u
#define DAC_CR_WAVE1 (0x3u << 6)
#define DAC_CR_WAVE1_AT 6u
#define DAC_CR_WAVE2 (0x3u << 22)
#define DAC_CR_WAVE2_AT 22u
#define DAC_CR_MAMP1 (0xfu << 8)
#define DAC_CR_MAMP1_AT 8u
#define DAC_CR_MAMP2 (0xfu << 24)
#define DAC_CR_MAMP2_AT 24u
#define DAC_CR_DMAEN1 (0x1u << 12)
#define DAC_CR_DMAEN2 (0x1u << 28)
#define DAC_CR_DMAUDRIE1 (0x1u << 13)
#define DAC_CR_DMAUDRIE2 (0x1u << 29)
#define DAC_CR_TSEL2 (0x7u << 19)
#define DAC_CR_TSEL2_AT 19u

#define DAC_SWTRIGR 0x004u
#define DAC_SWTRIGR_SWTRIG1 (0x1u << 0)
#define DAC_SWTRIGR_SWTRIG2 (0x1u << 1)

#define DAC_DHR12R1 0x008u
#define DAC_DHR12R1_DACCDHR (0xfffu << 0)
#define DAC_DHR12R1_DACCDHR_AT 0u

#endif
