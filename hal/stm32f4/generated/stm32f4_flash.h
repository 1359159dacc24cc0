/// Registers of the STM32F4's FLASH. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_FLASH_H
#define STM32F4_FLASH_H

#define FLASH_BASE 0x40023c00u

#define FLASH_ACR 0x000u
#define FLASH_ACR_PRFTEN (0x1u << 8)
#define FLASH_ACR_ICEN (0x1u << 9)
#define FLASH_ACR_DCEN (0x1u << 10)
#define FLASH_ACR_DCRST (0x1u << 12)
#define FLASH_ACR_ICRST (0x1u << 11)

#define FLASH_KEYR 0x004u
#define FLASH_KEYR_KEY (0xffffffffu << 0)
#define FLASH_KEYR_KEY_AT 0u

#define FLASH_SR 0x00cu
#define FLASH_SR_EOP (0x1u << 0)
#define FLASH_SR_OPERR (0x1u << 1)
#define FLASH_SR_WRPERR (0x1u << 4)
#define FLASH_SR_PGAERR (0x1u << 5)
#define FLASH_SR_PGPERR (0x1u << 6)
#define FLASH_SR_PGSERR (0x1u << 7)
#define FLASH_SR_BSY (0x1u << 16)

#define FLASH_CR 0x010u
#define FLASH_CR_PG (0x1u << 0)
#define FLASH_CR_SER (0x1u << 1)
#define FLASH_CR_MER (0x1u << 2)
#define FLASH_CR_SNB (0xfu << 3)
#define FLASH_CR_SNB_AT 3u
#define FLASH_CR_PSIZE (0x3u << 8)
#define FLASH_CR_PSIZE_AT 8u
#define FLASH_CR_STRT (0x1u << 16)
#define FLASH_CR_EOPIE (0x1u << 24)
#define FLASH_CR_ERRIE (0x1u << 25)
#define FLASH_CR_LOCK (0x1u << 31)

#endif
