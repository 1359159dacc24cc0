/// Registers of the STM32F4's IWDG. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_IWDG_H
#define STM32F4_IWDG_H

#define IWDG_BASE 0x40003000u

#define IWDG_KR 0x000u
#define IWDG_KR_KEY (0xffffu << 0)
#define IWDG_KR_KEY_AT 0u

#define IWDG_PR 0x004u
#define IWDG_PR_PR (0x7u << 0)
#define IWDG_PR_PR_AT 0u

#define IWDG_RLR 0x008u
#define IWDG_RLR_RL (0xfffu << 0)
#define IWDG_RLR_RL_AT 0u

#define IWDG_SR 0x00cu
#define IWDG_SR_PVU (0x1u << 0)
#define IWDG_SR_RVU (0x1u << 1)

#endif
