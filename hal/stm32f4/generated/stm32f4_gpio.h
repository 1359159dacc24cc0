/// Registers of the STM32F4's GPIO. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_GPIO_H
#define STM32F4_GPIO_H

#define GPIOA_BASE 0x40020000u
#define GPIOB_BASE 0x40020400u
#define GPIOC_BASE 0x40020800u

#define GPIO_MODER 0x000u
#define GPIO_MODER_MODER0 (0x3u << 0)
#define GPIO_MODER_MODER0_AT 0u
#define GPIO_MODER_MODER1 (0x3u << 2)
#define GPIO_MODER_MODER1_AT 2u
#define GPIO_MODER_MODER2 (0x3u << 4)
#define GPIO_MODER_MODER2_AT 4u
#define GPIO_MODER_MODER3 (0x3u << 6)
#define GPIO_MODER_MODER3_AT 6u
#define GPIO_MODER_MODER4 (0x3u << 8)
#define GPIO_MODER_MODER4_AT 8u
#define GPIO_MODER_MODER5 (0x3u << 10)
#define GPIO_MODER_MODER5_AT 10u
#define GPIO_MODER_MODER6 (0x3u << 12)
#define GPIO_MODER_MODER6_AT 12u
#define GPIO_MODER_MODER7 (0x3u << 14)
#define GPIO_MODER_MODER7_AT 14u
#define GPIO_MODER_MODER8 (0x3u << 16)
#define GPIO_MODER_MODER8_AT 16u
#define GPIO_MODER_MODER9 (0x3u << 18)
#define GPIO_MODER_MODER9_AT 18u
#define GPIO_MODER_MODER10 (0x3u << 20)
#define GPIO_MODER_MODER10_AT 20u
#define GPIO_MODER_MODER11 (0x3u << 22)
#define GPIO_MODER_MODER11_AT 22u
#define GPIO_MODER_MODER12 (0x3u << 24)
#define GPIO_MODER_MODER12_AT 24u
#define GPIO_MODER_MODER13 (0x3u << 26)
#define GPIO_MODER_MODER13_AT 26u
#define GPIO_MODER_MODER14 (0x3u << 28)
#define GPIO_MODER_MODER14_AT 28u
#define GPIO_MODER_MODER15 (0x3u << 30)
#define GPIO_MODER_MODER15_AT 30u

#define GPIO_OTYPER 0x004u
#define GPIO_OTYPER_OT0 (0x1u << 0)
#define GPIO_OTYPER_OT1 (0x1u << 1)
#define GPIO_OTYPER_OT2 (0x1u << 2)
#define GPIO_OTYPER_OT3 (0x1u << 3)
#define GPIO_OTYPER_OT4 (0x1u << 4)
#define GPIO_OTYPER_OT5 (0x1u << 5)
#define GPIO_OTYPER_OT6 (0x1u << 6)
#define GPIO_OTYPER_OT7 (0x1u << 7)
#define GPIO_OTYPER_OT8 (0x1u << 8)
#define GPIO_OTYPER_OT9 (0x1u << 9)
#define GPIO_OTYPER_OT10 (0x1u << 10)
#define GPIO_OTYPER_OT11 (0x1u << 11)
#define GPIO_OTYPER_OT12 (0x1u << 12)
#define GPIO_OTYPER_OT13 (0x1u << 13)
#define GPIO_OTYPER_OT14 (0x1u << 14)
#define GPIO_OTYPER_OT15 (0x1u << 15)

#define GPIO_OSPEEDR 0x008u
#define GPIO_OSPEEDR_OSPEEDR0 (0x3u << 0)
#define GPIO_OSPEEDR_OSPEEDR0_AT 0u
#define GPIO_OSPEEDR_OSPEEDR1 (0x3u << 2)
#define GPIO_OSPEEDR_OSPEEDR1_AT 2u
#define GPIO_OSPEEDR_OSPEEDR2 (0x3u << 4)
#define GPIO_OSPEEDR_OSPEEDR2_AT 4u
#define GPIO_OSPEEDR_OSPEEDR3 (0x3u << 6)
#define GPIO_OSPEEDR_OSPEEDR3_AT 6u
#define GPIO_OSPEEDR_OSPEEDR4 (0x3u << 8)
#define GPIO_OSPEEDR_OSPEEDR4_AT 8u
#define GPIO_OSPEEDR_OSPEEDR5 (0x3u << 10)
#define GPIO_OSPEEDR_OSPEEDR5_AT 10u
#define GPIO_OSPEEDR_OSPEEDR6 (0x3u << 12)
#define GPIO_OSPEEDR_OSPEEDR6_AT 12u
#define GPIO_OSPEEDR_OSPEEDR7 (0x3u << 14)
#define GPIO_OSPEEDR_OSPEEDR7_AT 14u
#define GPIO_OSPEEDR_OSPEEDR8 (0x3u << 16)
#define GPIO_OSPEEDR_OSPEEDR8_AT 16u
#define GPIO_OSPEEDR_OSPEEDR9 (0x3u << 18)
#define GPIO_OSPEEDR_OSPEEDR9_AT 18u
#define GPIO_OSPEEDR_OSPEEDR10 (0x3u << 20)
#define GPIO_OSPEEDR_OSPEEDR10_AT 20u
#define GPIO_OSPEEDR_OSPEEDR11 (0x3u << 22)
#define GPIO_OSPEEDR_OSPEEDR11_AT 22u
#define GPIO_OSPEEDR_OSPEEDR12 (0x3u << 24)
#define GPIO_OSPEEDR_OSPEEDR12_AT 24u
#define GPIO_OSPEEDR_OSPEEDR13 (0x3u << 26)
#define GPIO_OSPEEDR_OSPEEDR13_AT 26u
#define GPIO_OSPEEDR_OSPEEDR14 (0x3u << 28)
#define GPIO_OSPEEDR_OSPEEDR14_AT 28u
#define GPIO_OSPEEDR_OSPEEDR15 (0x3u << 30)
#define GPIO_OSPEEDR_OSPEEDR15_AT 30u

#define GPIO_PUPDR 0x00cu
#define GPIO_PUPDR_PUPDR0 (0x3u << 0)
#define GPIO_PUPDR_PUPDR0_AT 0u
#define GPIO_PUPDR_PUPDR1 (0x3u << 2)
#define GPIO_PUPDR_PUPDR1_AT 2u
#define GPIO_PUPDR_PUPDR2 (0x3u << 4)
#define GPIO_PUPDR_PUPDR2_AT 4u
#define GPIO_PUPDR_PUPDR3 (0x3u << 6)
#define GPIO_PUPDR_PUPDR3_AT 6u
#define GPIO_PUPDR_PUPDR4 (0x3u << 8)
#define GPIO_PUPDR_PUPDR4_AT 8u
#define GPIO_PUPDR_PUPDR5 (0x3u << 10)
#define GPIO_PUPDR_PUPDR5_AT 10u
#define GPIO_PUPDR_PUPDR6 (0x3u << 12)
#define GPIO_PUPDR_PUPDR6_AT 12u
#define GPIO_PUPDR_PUPDR7 (0x3u << 14)
#define GPIO_PUPDR_PUPDR7_AT 14u
#define GPIO_PUPDR_PUPDR8 (0x3u << 16)
#define GPIO_PUPDR_PUPDR8_AT 16u
#define GPIO_PUPDR_PUPDR9 (0x3u << 18)
#define GPIO_PUPDR_PUPDR9_AT 18u
#define GPIO_PUPDR_PUPDR10 (0x3u << 20)
#define GPIO_PUPDR_PUPDR10_AT 20u
#define GPIO_PUPDR_PUPDR11 (0x3u << 22)
#define GPIO_PUPDR_PUPDR11_AT 22u
#define GPIO_PUPDR_PUPDR12 (0x3u << 24)
#define GPIO_PUPDR_PUPDR12_AT 24u
#define GPIO_PUPDR_PUPDR13 (0x3u << 26)
#define GPIO_PUPDR_PUPDR13_AT 26u
#define GPIO_PUPDR_PUPDR14 (0x3u << 28)
#define GPIO_PUPDR_PUPDR14_AT 28u
#define GPIO_PUPDR_PUPDR15 (0x3u << 30)
#define GPIO_PUPDR_PUPDR15_AT 30u

#define GPIO_IDR 0x010u
#define GPIO_IDR_IDR0 (0x1u << 0)
#define GPIO_IDR_IDR1 (0x1u << 1)
#define GPIO_IDR_IDR2 (0x1u << 2)
#define GPIO_IDR_IDR3 (0x1u << 3)
#define GPIO_IDR_IDR4 (0x1u << 4)
#define GPIO_IDR_IDR5 (0x1u << 5)
#define GPIO_IDR_IDR6 (0x1u << 6)
#define GPIO_IDR_IDR7 (0x1u << 7)
#define GPIO_IDR_IDR8 (0x1u << 8)
#define GPIO_IDR_IDR9 (0x1u << 9)
#define GPIO_IDR_IDR10 (0x1u << 10)
#define GPIO_IDR_IDR11 (0x1u << 11)
#define GPIO_IDR_IDR12 (0x1u << 12)
#define GPIO_IDR_IDR13 (0x1u << 13)
#define GPIO_IDR_IDR14 (0x1u << 14)
#define GPIO_IDR_IDR15 (0x1u << 15)

#define GPIO_ODR 0x014u
#define GPIO_ODR_ODR0 (0x1u << 0)
#define GPIO_ODR_ODR1 (0x1u << 1)
#define GPIO_ODR_ODR2 (0x1u << 2)
#define GPIO_ODR_ODR3 (0x1u << 3)
#define GPIO_ODR_ODR4 (0x1u << 4)
#define GPIO_ODR_ODR5 (0x1u << 5)
#define GPIO_ODR_ODR6 (0x1u << 6)
#define GPIO_ODR_ODR7 (0x1u << 7)
#define GPIO_ODR_ODR8 (0x1u << 8)
#define GPIO_ODR_ODR9 (0x1u << 9)
#define GPIO_ODR_ODR10 (0x1u << 10)
#define GPIO_ODR_ODR11 (0x1u << 11)
#define GPIO_ODR_ODR12 (0x1u << 12)
#define GPIO_ODR_ODR13 (0x1u << 13)
#define GPIO_ODR_ODR14 (0x1u << 14)
#define GPIO_ODR_ODR15 (0x1u << 15)

#define GPIO_BSRR 0x018u
#define GPIO_BSRR_BS0 (0x1u << 0)
#define GPIO_BSRR_BS1 (0x1u << 1)
#define GPIO_BSRR_BS2 (0x1u << 2)
#define GPIO_BSRR_BS3 (0x1u << 3)
#define GPIO_BSRR_BS4 (0x1u << 4)
#define GPIO_BSRR_BS5 (0x1u << 5)
#define GPIO_BSRR_BS6 (0x1u << 6)
#define GPIO_BSRR_BS7 (0x1u << 7)
#define GPIO_BSRR_BS8 (0x1u << 8)
#define GPIO_BSRR_BS9 (0x1u << 9)
#define GPIO_BSRR_BS10 (0x1u << 10)
#define GPIO_BSRR_BS11 (0x1u << 11)
#define GPIO_BSRR_BS12 (0x1u << 12)
#define GPIO_BSRR_BS13 (0x1u << 13)
#define GPIO_BSRR_BS14 (0x1u << 14)
#define GPIO_BSRR_BS15 (0x1u << 15)
#define GPIO_BSRR_BR0 (0x1u << 16)
#define GPIO_BSRR_BR1 (0x1u << 17)
#define GPIO_BSRR_BR2 (0x1u << 18)
#define GPIO_BSRR_BR3 (0x1u << 19)
#define GPIO_BSRR_BR4 (0x1u << 20)
#define GPIO_BSRR_BR5 (0x1u << 21)
#define GPIO_BSRR_BR6 (0x1u << 22)
#define GPIO_BSRR_BR7 (0x1u << 23)
#define GPIO_BSRR_BR8 (0x1u << 24)
#define GPIO_BSRR_BR9 (0x1u << 25)
#define GPIO_BSRR_BR10 (0x1u << 26)
#define GPIO_BSRR_BR11 (0x1u << 27)
#define GPIO_BSRR_BR12 (0x1u << 28)
#define GPIO_BSRR_BR13 (0x1u << 29)
#define GPIO_BSRR_BR14 (0x1u << 30)
#define GPIO_BSRR_BR15 (0x1u << 31)

#define GPIO_AFRL 0x020u
#define GPIO_AFRL_AFRL0 (0xfu << 0)
#define GPIO_AFRL_AFRL0_AT 0u
#define GPIO_AFRL_AFRL1 (0xfu << 4)
#define GPIO_AFRL_AFRL1_AT 4u
#define GPIO_AFRL_AFRL2 (0xfu << 8)
#define GPIO_AFRL_AFRL2_AT 8u
#define GPIO_AFRL_AFRL3 (0xfu << 12)
#define GPIO_AFRL_AFRL3_AT 12u
#define GPIO_AFRL_AFRL4 (0xfu << 16)
#define GPIO_AFRL_AFRL4_AT 16u
#define GPIO_AFRL_AFRL5 (0xfu << 20)
#define GPIO_AFRL_AFRL5_AT 20u
#define GPIO_AFRL_AFRL6 (0xfu << 24)
#define GPIO_AFRL_AFRL6_AT 24u
#define GPIO_AFRL_AFRL7 (0xfu << 28)
#define GPIO_AFRL_AFRL7_AT 28u

#define GPIO_AFRH 0x024u
#define GPIO_AFRH_AFRH8 (0xfu << 0)
#define GPIO_AFRH_AFRH8_AT 0u
#define GPIO_AFRH_AFRH9 (0xfu << 4)
#define GPIO_AFRH_AFRH9_AT 4u
#define GPIO_AFRH_AFRH10 (0xfu << 8)
#define GPIO_AFRH_AFRH10_AT 8u
#define GPIO_AFRH_AFRH11 (0xfu << 12)
#define GPIO_AFRH_AFRH11_AT 12u
#define GPIO_AFRH_AFRH12 (0xfu << 16)
#define GPIO_AFRH_AFRH12_AT 16u
#define GPIO_AFRH_AFRH13 (0xfu << 20)
#define GPIO_AFRH_AFRH13_AT 20u
#define GPIO_AFRH_AFRH14 (0xfu << 24)
#define GPIO_AFRH_AFRH14_AT 24u
#define GPIO_AFRH_AFRH15 (0xfu << 28)
#define GPIO_AFRH_AFRH15_AT 28u

#endif
