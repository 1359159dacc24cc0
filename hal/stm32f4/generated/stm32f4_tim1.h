/// Registers of the STM32F4's TIM1. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_TIM1_H
#define STM32F4_TIM1_H

#define TIM1_BASE 0x40010000u

#define TIM1_CR1 0x000u
#define TIM1_CR1_CEN (0x1u << 0)
#define TIM1_CR1_UDIS (0x1u << 1)
#define TIM1_CR1_URS (0x1u << 2)
#define TIM1_CR1_OPM (0x1u << 3)
#define TIM1_CR1_DIR (0x1u << 4)
#define TIM1_CR1_CMS (0x3u << 5)
#define TIM1_CR1_CMS_AT 5u
#define TIM1_CR1_ARPE (0x1u << 7)
#define TIM1_CR1_CKD (0x3u << 8)
#define TIM1_CR1_CKD_AT 8u

#define TIM1_CR2 0x004u
#define TIM1_CR2_CCPC (0x1u << 0)
#define TIM1_CR2_CCUS (0x1u << 2)
#define TIM1_CR2_CCDS (0x1u << 3)
#define TIM1_CR2_MMS (0x7u << 4)
#define TIM1_CR2_MMS_AT 4u
#define TIM1_CR2_TI1S (0x1u << 7)
#define TIM1_CR2_OIS1 (0x1u << 8)
#define TIM1_CR2_OIS2 (0x1u << 10)
#define TIM1_CR2_OIS3 (0x1u << 12)
#define TIM1_CR2_OIS4 (0x1u << 14)
#define TIM1_CR2_OIS1N (0x1u << 9)
#define TIM1_CR2_OIS2N (0x1u << 11)
#define TIM1_CR2_OIS3N (0x1u << 13)

#define TIM1_DIER 0x00cu
#define TIM1_DIER_UIE (0x1u << 0)
#define TIM1_DIER_CC1IE (0x1u << 1)
#define TIM1_DIER_CC2IE (0x1u << 2)
#define TIM1_DIER_CC3IE (0x1u << 3)
#define TIM1_DIER_CC4IE (0x1u << 4)
#define TIM1_DIER_COMIE (0x1u << 5)
#define TIM1_DIER_TIE (0x1u << 6)
#define TIM1_DIER_BIE (0x1u << 7)
#define TIM1_DIER_UDE (0x1u << 8)
#define TIM1_DIER_CC1DE (0x1u << 9)
#define TIM1_DIER_CC2DE (0x1u << 10)
#define TIM1_DIER_CC3DE (0x1u << 11)
#define TIM1_DIER_CC4DE (0x1u << 12)
#define TIM1_DIER_COMDE (0x1u << 13)
#define TIM1_DIER_TDE (0x1u << 14)

#define TIM1_SR 0x010u
#define TIM1_SR_UIF (0x1u << 0)
#define TIM1_SR_CC1IF (0x1u << 1)
#define TIM1_SR_CC2IF (0x1u << 2)
#define TIM1_SR_CC3IF (0x1u << 3)
#define TIM1_SR_CC4IF (0x1u << 4)
#define TIM1_SR_COMIF (0x1u << 5)
#define TIM1_SR_TIF (0x1u << 6)
#define TIM1_SR_BIF (0x1u << 7)
#define TIM1_SR_CC1OF (0x1u << 9)
#define TIM1_SR_CC2OF (0x1u << 10)
#define TIM1_SR_CC3OF (0x1u << 11)
#define TIM1_SR_CC4OF (0x1u << 12)

#define TIM1_EGR 0x014u
#define TIM1_EGR_UG (0x1u << 0)
#define TIM1_EGR_CC1G (0x1u << 1)
#define TIM1_EGR_CC2G (0x1u << 2)
#define TIM1_EGR_CC3G (0x1u << 3)
#define TIM1_EGR_CC4G (0x1u << 4)
#define TIM1_EGR_COMG (0x1u << 5)
#define TIM1_EGR_TG (0x1u << 6)
#define TIM1_EGR_BG (0x1u << 7)

#define TIM1_CCMR1_OUTPUT 0x018u
#define TIM1_CCMR1_OUTPUT_CC1S (0x3u << 0)
#define TIM1_CCMR1_OUTPUT_CC1S_AT 0u
#define TIM1_CCMR1_OUTPUT_CC2S (0x3u << 8)
#define TIM1_CCMR1_OUTPUT_CC2S_AT 8u
#define TIM1_CCMR1_OUTPUT_OC1FE (0x1u << 2)
#define TIM1_CCMR1_OUTPUT_OC2FE (0x1u << 10)
#define TIM1_CCMR1_OUTPUT_OC1PE (0x1u << 3)
#define TIM1_CCMR1_OUTPUT_OC2PE (0x1u << 11)
#define TIM1_CCMR1_OUTPUT_OC1M (0x7u << 4)
#define TIM1_CCMR1_OUTPUT_OC1M_AT 4u
#define TIM1_CCMR1_OUTPUT_OC2M (0x7u << 12)
#define TIM1_CCMR1_OUTPUT_OC2M_AT 12u
#define TIM1_CCMR1_OUTPUT_OC1CE (0x1u << 7)
#define TIM1_CCMR1_OUTPUT_OC2CE (0x1u << 15)

#define TIM1_CCMR2_OUTPUT 0x01cu
#define TIM1_CCMR2_OUTPUT_CC3S (0x3u << 0)
#define TIM1_CCMR2_OUTPUT_CC3S_AT 0u
#define TIM1_CCMR2_OUTPUT_CC4S (0x3u << 8)
#define TIM1_CCMR2_OUTPUT_CC4S_AT 8u
#define TIM1_CCMR2_OUTPUT_OC3FE (0x1u << 2)
#define TIM1_CCMR2_OUTPUT_OC4FE (0x1u << 10)
#define TIM1_CCMR2_OUTPUT_OC3PE (0x1u << 3)
#define TIM1_CCMR2_OUTPUT_OC4PE (0x1u << 11)
#define TIM1_CCMR2_OUTPUT_OC3M (0x7u << 4)
#define TIM1_CCMR2_OUTPUT_OC3M_AT 4u
#define TIM1_CCMR2_OUTPUT_OC4M (0x7u << 12)
#define TIM1_CCMR2_OUTPUT_OC4M_AT 12u
#define TIM1_CCMR2_OUTPUT_OC3CE (0x1u << 7)
#define TIM1_CCMR2_OUTPUT_OC4CE (0x1u << 15)

#define TIM1_CCER 0x020u
#define TIM1_CCER_CC1E (0x1u << 0)
#define TIM1_CCER_CC2E (0x1u << 4)
#define TIM1_CCER_CC3E (0x1u << 8)
#define TIM1_CCER_CC4E (0x1u << 12)
#define TIM1_CCER_CC1P (0x1u << 1)
#define TIM1_CCER_CC2P (0x1u << 5)
#define TIM1_CCER_CC3P (0x1u << 9)
#define TIM1_CCER_CC4P (0x1u << 13)
#define TIM1_CCER_CC1NE (0x1u << 2)
#define TIM1_CCER_CC2NE (0x1u << 6)
#define TIM1_CCER_CC3NE (0x1u << 10)
#define TIM1_CCER_CC1NP (0x1u << 3)
#define TIM1_CCER_CC2NP (0x1u << 7)
#define TIM1_CCER_CC3NP (0x1u << 11)

#define TIM1_CNT 0x024u
#define TIM1_CNT_CNT (0xffffu << 0)
#define TIM1_CNT_CNT_AT 0u

#define TIM1_PSC 0x028u
#define TIM1_PSC_PSC (0xffffu << 0)
#define TIM1_PSC_PSC_AT 0u

#define TIM1_ARR 0x02cu
#define TIM1_ARR_ARR (0xffffu << 0)
#define TIM1_ARR_ARR_AT 0u

#define TIM1_RCR 0x030u
#define TIM1_RCR_REP (0xffu << 0)
#define TIM1_RCR_REP_AT 0u

#define TIM1_CCR1 0x034u
#define TIM1_CCR1_CCR (0xffffu << 0)
#define TIM1_CCR1_CCR_AT 0u

#define TIM1_CCR4 0x040u
#define TIM1_CCR4_CCR (0xffffu << 0)
#define TIM1_CCR4_CCR_AT 0u

#define TIM1_BDTR 0x044u
#define TIM1_BDTR_DTG (0xffu << 0)
#define TIM1_BDTR_DTG_AT 0u
#define TIM1_BDTR_LOCK (0x3u << 8)
#define TIM1_BDTR_LOCK_AT 8u
#define TIM1_BDTR_OSSI (0x1u << 10)
#define TIM1_BDTR_OSSR (0x1u << 11)
#define TIM1_BDTR_BKE (0x1u << 12)
#define TIM1_BDTR_BKP (0x1u << 13)
#define TIM1_BDTR_AOE (0x1u << 14)
#define TIM1_BDTR_MOE (0x1u << 15)

#endif
