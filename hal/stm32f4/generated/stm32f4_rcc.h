/// Registers of the STM32F4's RCC. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_RCC_H
#define STM32F4_RCC_H

#define RCC_BASE 0x40023800u

#define RCC_CR 0x000u
#define RCC_CR_HSION (0x1u << 0)
#define RCC_CR_HSIRDY (0x1u << 1)
#define RCC_CR_HSITRIM (0x1fu << 3)
#define RCC_CR_HSITRIM_AT 3u
#define RCC_CR_HSICAL (0xffu << 8)
#define RCC_CR_HSICAL_AT 8u
#define RCC_CR_HSEON (0x1u << 16)
#define RCC_CR_HSERDY (0x1u << 17)
#define RCC_CR_HSEBYP (0x1u << 18)
#define RCC_CR_CSSON (0x1u << 19)
#define RCC_CR_PLLON (0x1u << 24)
#define RCC_CR_PLLRDY (0x1u << 25)
#define RCC_CR_PLLI2SON (0x1u << 26)
#define RCC_CR_PLLI2SRDY (0x1u << 27)

#define RCC_PLLCFGR 0x004u
#define RCC_PLLCFGR_PLLM (0x3fu << 0)
#define RCC_PLLCFGR_PLLM_AT 0u
#define RCC_PLLCFGR_PLLN (0x1ffu << 6)
#define RCC_PLLCFGR_PLLN_AT 6u
#define RCC_PLLCFGR_PLLP (0x3u << 16)
#define RCC_PLLCFGR_PLLP_AT 16u
#define RCC_PLLCFGR_PLLSRC (0x1u << 22)
#define RCC_PLLCFGR_PLLQ (0xfu << 24)
#define RCC_PLLCFGR_PLLQ_AT 24u

#define RCC_CFGR 0x008u
#define RCC_CFGR_SW (0x3u << 0)
#define RCC_CFGR_SW_AT 0u
#define RCC_CFGR_SWS (0x3u << 2)
#define RCC_CFGR_SWS_AT 2u
#define RCC_CFGR_HPRE (0xfu << 4)
#define RCC_CFGR_HPRE_AT 4u
#define RCC_CFGR_PPRE1 (0x7u << 10)
#define RCC_CFGR_PPRE1_AT 10u
#define RCC_CFGR_PPRE2 (0x7u << 13)
#define RCC_CFGR_PPRE2_AT 13u
#define RCC_CFGR_RTCPRE (0x1fu << 16)
#define RCC_CFGR_RTCPRE_AT 16u
#define RCC_CFGR_MCO1 (0x3u << 21)
#define RCC_CFGR_MCO1_AT 21u
#define RCC_CFGR_I2SSRC (0x1u << 23)
#define RCC_CFGR_MCO1PRE (0x7u << 24)
#define RCC_CFGR_MCO1PRE_AT 24u
#define RCC_CFGR_MCO2PRE (0x7u << 27)
#define RCC_CFGR_MCO2PRE_AT 27u
#define RCC_CFGR_MCO2 (0x3u << 30)
#define RCC_CFGR_MCO2_AT 30u

#define RCC_AHB1ENR 0x030u
#define RCC_AHB1ENR_GPIOAEN (0x1u << 0)
#define RCC_AHB1ENR_GPIOBEN (0x1u << 1)
#define RCC_AHB1ENR_GPIOCEN (0x1u << 2)
#define RCC_AHB1ENR_GPIODEN (0x1u << 3)
#define RCC_AHB1ENR_GPIOEEN (0x1u << 4)
#define RCC_AHB1ENR_GPIOFEN (0x1u << 5)
#define RCC_AHB1ENR_GPIOGEN (0x1u << 6)
#define RCC_AHB1ENR_GPIOHEN (0x1u << 7)
#define RCC_AHB1ENR_CRCEN (0x1u << 12)
#define RCC_AHB1ENR_BKPSRAMEN (0x1u << 18)
#define RCC_AHB1ENR_DMA1EN (0x1u << 21)
#define RCC_AHB1ENR_DMA2EN (0x1u << 22)
#define RCC_AHB1ENR_OTGHSEN (0x1u << 29)
#define RCC_AHB1ENR_OTGHSULPIEN (0x1u << 30)

#define RCC_APB1ENR 0x040u
#define RCC_APB1ENR_TIM2EN (0x1u << 0)
#define RCC_APB1ENR_TIM3EN (0x1u << 1)
#define RCC_APB1ENR_TIM4EN (0x1u << 2)
#define RCC_APB1ENR_TIM5EN (0x1u << 3)
#define RCC_APB1ENR_TIM6EN (0x1u << 4)
#define RCC_APB1ENR_TIM7EN (0x1u << 5)
#define RCC_APB1ENR_TIM12EN (0x1u << 6)
#define RCC_APB1ENR_TIM13EN (0x1u << 7)
#define RCC_APB1ENR_TIM14EN (0x1u << 8)
#define RCC_APB1ENR_WWDGEN (0x1u << 11)
#define RCC_APB1ENR_SPI2EN (0x1u << 14)
#define RCC_APB1ENR_SPI3EN (0x1u << 15)
#define RCC_APB1ENR_USART2EN (0x1u << 17)
#define RCC_APB1ENR_USART3EN (0x1u << 18)
#define RCC_APB1ENR_UART4EN (0x1u << 19)
#define RCC_APB1ENR_UART5EN (0x1u << 20)
#define RCC_APB1ENR_I2C1EN (0x1u << 21)
#define RCC_APB1ENR_I2C2EN (0x1u << 22)
#define RCC_APB1ENR_I2C3EN (0x1u << 23)
#define RCC_APB1ENR_CAN1EN (0x1u << 25)
#define RCC_APB1ENR_CAN2EN (0x1u << 26)
#define RCC_APB1ENR_PWREN (0x1u << 28)
#define RCC_APB1ENR_DACEN (0x1u << 29)

#define RCC_APB2ENR 0x044u
#define RCC_APB2ENR_TIM1EN (0x1u << 0)
#define RCC_APB2ENR_TIM8EN (0x1u << 1)
#define RCC_APB2ENR_USART1EN (0x1u << 4)
#define RCC_APB2ENR_USART6EN (0x1u << 5)
#define RCC_APB2ENR_ADC1EN (0x1u << 8)
#define RCC_APB2ENR_ADC2EN (0x1u << 9)
#define RCC_APB2ENR_ADC3EN (0x1u << 10)
#define RCC_APB2ENR_SDIOEN (0x1u << 11)
#define RCC_APB2ENR_SPI1EN (0x1u << 12)
#define RCC_APB2ENR_SYSCFGEN (0x1u << 14)
#define RCC_APB2ENR_TIM9EN (0x1u << 16)
#define RCC_APB2ENR_TIM10EN (0x1u << 17)
#define RCC_APB2ENR_TIM11EN (0x1u << 18)

#define RCC_CSR 0x074u
#define RCC_CSR_LSION (0x1u << 0)
#define RCC_CSR_LSIRDY (0x1u << 1)
#define RCC_CSR_RMVF (0x1u << 24)
#define RCC_CSR_BORRSTF (0x1u << 25)
#define RCC_CSR_PADRSTF (0x1u << 26)
#define RCC_CSR_PORRSTF (0x1u << 27)
#define RCC_CSR_SFTRSTF (0x1u << 28)
#define RCC_CSR_WDGRSTF (0x1u << 29)
#define RCC_CSR_WWDGRSTF (0x1u << 30)
#define RCC_CSR_LPWRRSTF (0x1u << 31)

#endif
