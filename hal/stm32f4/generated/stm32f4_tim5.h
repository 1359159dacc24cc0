/// Registers of the STM32F4's TIM5. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_TIM5_H
#define STM32F4_TIM5_H

#define TIM5_BASE 0x40000c00u

#define TIM5_CR1 0x000u
#define TIM5_CR1_CEN (0x1u << 0)
#define TIM5_CR1_UDIS (0x1u << 1)
#define TIM5_CR1_URS (0x1u << 2)
#define TIM5_CR1_OPM (0x1u << 3)
#define TIM5_CR1_DIR (0x1u << 4)
#define TIM5_CR1_CMS (0x3u << 5)
#define TIM5_CR1_CMS_AT 5u
#define TIM5_CR1_ARPE (0x1u << 7)
#define TIM5_CR1_CKD (0x3u << 8)
#define TIM5_CR1_CKD_AT 8u

#define TIM5_SR 0x010u
#define TIM5_SR_UIF (0x1u << 0)
#define TIM5_SR_CC1IF (0x1u << 1)
#define TIM5_SR_CC2IF (0x1u << 2)
#define TIM5_SR_CC3IF (0x1u << 3)
#define TIM5_SR_CC4IF (0x1u << 4)
#define TIM5_SR_TIF (0x1u << 6)
#define TIM5_SR_CC1OF (0x1u << 9)
#define TIM5_SR_CC2OF (0x1u << 10)
#define TIM5_SR_CC3OF (0x1u << 11)
#define TIM5_SR_CC4OF (0x1u << 12)

#define TIM5_EGR 0x014u
#define TIM5_EGR_UG (0x1u << 0)
#define TIM5_EGR_CC1G (0x1u << 1)
#define TIM5_EGR_CC2G (0x1u << 2)
#define TIM5_EGR_CC3G (0x1u << 3)
#define TIM5_EGR_CC4G (0x1u << 4)
#define TIM5_EGR_TG (0x1u << 6)

#define TIM5_CNT 0x024u
#define TIM5_CNT_CNT (0xffffffffu << 0)
#define TIM5_CNT_CNT_AT 0u

#define TIM5_PSC 0x028u
#define TIM5_PSC_PSC (0xffffu << 0)
#define TIM5_PSC_PSC_AT 0u

#define TIM5_ARR 0x02cu
#define TIM5_ARR_ARR (0xffffffffu << 0)
#define TIM5_ARR_ARR_AT 0u

#endif
