/// Registers of the STM32F4's PWR. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_PWR_H
#define STM32F4_PWR_H

#define PWR_BASE 0x40007000u

#define PWR_CR 0x000u
#define PWR_CR_LPDS (0x1u << 0)
#define PWR_CR_PDDS (0x1u << 1)
#define PWR_CR_CWUF (0x1u << 2)
#define PWR_CR_CSBF (0x1u << 3)
#define PWR_CR_PVDE (0x1u << 4)
#define PWR_CR_PLS (0x7u << 5)
#define PWR_CR_PLS_AT 5u
#define PWR_CR_DBP (0x1u << 8)
#define PWR_CR_FPDS (0x1u << 9)

#define PWR_CSR 0x004u
#define PWR_CSR_WUF (0x1u << 0)
#define PWR_CSR_SBF (0x1u << 1)
#define PWR_CSR_PVDO (0x1u << 2)
#define PWR_CSR_BRR (0x1u << 3)
#define PWR_CSR_BRE (0x1u << 9)
#define PWR_CSR_VOSRDY (0x1u << 14)

#endif
