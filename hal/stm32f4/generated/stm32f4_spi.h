/// Registers of the STM32F4's SPI. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_SPI_H
#define STM32F4_SPI_H

#define SPI1_BASE 0x40013000u
#define SPI2_BASE 0x40003800u

#define SPI_CR1 0x000u
#define SPI_CR1_CPHA (0x1u << 0)
#define SPI_CR1_CPOL (0x1u << 1)
#define SPI_CR1_MSTR (0x1u << 2)
#define SPI_CR1_BR (0x7u << 3)
#define SPI_CR1_BR_AT 3u
#define SPI_CR1_SPE (0x1u << 6)
#define SPI_CR1_LSBFIRST (0x1u << 7)
#define SPI_CR1_SSI (0x1u << 8)
#define SPI_CR1_SSM (0x1u << 9)
#define SPI_CR1_RXONLY (0x1u << 10)
#define SPI_CR1_DFF (0x1u << 11)
#define SPI_CR1_CRCNEXT (0x1u << 12)
#define SPI_CR1_CRCEN (0x1u << 13)
#define SPI_CR1_BIDIOE (0x1u << 14)
#define SPI_CR1_BIDIMODE (0x1u << 15)

#define SPI_CR2 0x004u
#define SPI_CR2_RXDMAEN (0x1u << 0)
#define SPI_CR2_TXDMAEN (0x1u << 1)
#define SPI_CR2_SSOE (0x1u << 2)
#define SPI_CR2_FRF (0x1u << 4)
#define SPI_CR2_ERRIE (0x1u << 5)
#define SPI_CR2_RXNEIE (0x1u << 6)
#define SPI_CR2_TXEIE (0x1u << 7)

#define SPI_SR 0x008u
#define SPI_SR_RXNE (0x1u << 0)
#define SPI_SR_TXE (0x1u << 1)
#define SPI_SR_CHSIDE (0x1u << 2)
#define SPI_SR_UDR (0x1u << 3)
#define SPI_SR_CRCERR (0x1u << 4)
#define SPI_SR_MODF (0x1u << 5)
#define SPI_SR_OVR (0x1u << 6)
#define SPI_SR_BSY (0x1u << 7)
#define SPI_SR_FRE (0x1u << 8)

#define SPI_DR 0x00cu
#define SPI_DR_DR (0xffffu << 0)
#define SPI_DR_DR_AT 0u

#endif
