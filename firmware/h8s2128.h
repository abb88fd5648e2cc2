// Addresses and bits of the H8S/2128 registers that the firmware uses.
// SPDX-License-Identifier: Apache-2.0
//
// In addresses, all bits above bit 23 are 1. The chip ignores these bits, but with these bits set the
// compiler selects short addressing.
#ifndef KAZ_FIRMWARE_H8S2128_H
#define KAZ_FIRMWARE_H8S2128_H

#include "shared/base/types.h"

#define KZ_REG8(address) (*(volatile u8*)(0xFFFF0000UL | (address)))
#define KZ_REG16(address) (*(volatile u16*)(0xFFFF0000UL | (address)))

// System
#define STCR KZ_REG8(0xFFC3)
#define STCR_FLSHE 0x08  // if set, FF80..FF83 are flash registers
#define STCR_ICKS1 0x02  // TMR1 counts phi/2 at CKS=1
#define STCR_ICKS0 0x01  // TMR0 counts phi/2 at CKS=1
#define SYSCR KZ_REG8(0xFFC4)
#define SYSCR_XRST 0x08  // 1 after a reset by the RES pin, 0 after a reset by the watchdog
#define MSTPCRH KZ_REG8(0xFF86)
#define MSTPCRH_DTC 0x40
#define MSTPCRH_FRT 0x20
#define MSTPCRH_TMR01 0x10
#define MSTPCRH_PWM 0x08
#define MSTPCRH_ADC 0x02
#define MSTPCRH_RESET 0x3F
#define MSTPCRL KZ_REG8(0xFF87)
#define MSTPCRL_SCI0 0x80
#define MSTPCRL_RESET 0xFF

// Flash registers, accessible while STCR.FLSHE = 1
#define FLMCR1 KZ_REG8(0xFF80)
#define FLMCR1_SWE 0x40
#define FLMCR1_EV 0x08
#define FLMCR1_PV 0x04
#define FLMCR1_E 0x02
#define FLMCR1_P 0x01
#define FLMCR2 KZ_REG8(0xFF81)
#define FLMCR2_FLER 0x80  // error protection: flash is locked until reset
#define FLMCR2_ESU 0x02
#define FLMCR2_PSU 0x01
#define EBR1 KZ_REG8(0xFF82)
#define EBR2 KZ_REG8(0xFF83)

// Ports. A 1 in a DDR makes the pin an output. The DDRs are write-only.
#define P1DDR KZ_REG8(0xFFB0)
#define P2DDR KZ_REG8(0xFFB1)
#define P3DDR KZ_REG8(0xFFB4)
#define P4DDR KZ_REG8(0xFFB5)
#define P5DDR KZ_REG8(0xFFB8)
#define P6DDR KZ_REG8(0xFFB9)
#define P1DR KZ_REG8(0xFFB2)
#define P2DR KZ_REG8(0xFFB3)
#define P3DR KZ_REG8(0xFFB6)
#define P4DR KZ_REG8(0xFFB7)
#define P5DR KZ_REG8(0xFFBA)
#define P6DR KZ_REG8(0xFFBB)

// 8-bit PWM
#define PCSR KZ_REG8(0xFF82)
#define PCSR_PWCKB 0x04
#define PCSR_PWCKA 0x02
#define PWOERB KZ_REG8(0xFFD2)
#define PWOERA KZ_REG8(0xFFD3)
#define PWDPRB KZ_REG8(0xFFD4)
#define PWDPRA KZ_REG8(0xFFD5)
#define PWSL KZ_REG8(0xFFD6)
#define PWSL_PWCKE 0x80
#define PWSL_PWCKS 0x40
#define PWSL_ONE 0x20         // reserved bit: reads as 1, must be written as 1
#define PWDR KZ_REG8(0xFFD7)  // duty of the channel that PWSL selects

// 8-bit timers 0 and 1
#define TMR_TCR0 KZ_REG8(0xFFC8)
#define TMR_TCR1 KZ_REG8(0xFFC9)
#define TMR_TCSR0 KZ_REG8(0xFFCA)
#define TMR_TCSR1 KZ_REG8(0xFFCB)
#define TMR_TCORA0 KZ_REG8(0xFFCC)
#define TMR_TCORA1 KZ_REG8(0xFFCD)
#define TMR_TCORB0 KZ_REG8(0xFFCE)
#define TMR_TCORB1 KZ_REG8(0xFFCF)
#define TMR_CLEAR_AT_A 0x08
#define TMR_PHI_2 0x01  // with STCR_ICKSn
#define TMR_HIGH_AT_A 0x02
#define TMR_LOW_AT_B 0x04

// 16-bit free-running timer
#define FRT_TIER KZ_REG8(0xFF90)
#define FRT_TIER_OCIAE 0x08
#define FRT_TIER_ONE 0x01  // reserved bit: reads as 1, must be written as 1
#define FRT_TCSR KZ_REG8(0xFF91)
#define FRT_TCSR_OCFA 0x08
#define FRT_TCSR_OVF 0x02
#define FRT_TCSR_CCLRA 0x01
#define FRT_FRC KZ_REG16(0xFF92)
#define FRT_OCRA KZ_REG16(0xFF94)  // accessible while TOCR.OCRS = 0
#define FRT_TCR KZ_REG8(0xFF96)
#define FRT_TCR_PHI_8 0x01
#define FRT_TOCR KZ_REG8(0xFF97)

// Watchdog 0. Writes are words with a key in the upper byte.
#define WDT0_TCSR KZ_REG16(0xFFA8)
#define WDT0_TCNT KZ_REG16(0xFFA8)
#define WDT_TCSR_KEY 0xA500
#define WDT_TCNT_KEY 0x5A00
#define WDT_WATCHDOG 0x40
#define WDT_RUN 0x20
#define WDT_RESET 0x08
#define WDT_PHI_2 0x00
#define WDT_PHI_512 0x03

// Serial channel 0
#define SCI0_SMR KZ_REG8(0xFFD8)  // accessible while STCR.IICE = 0
#define SCI0_BRR KZ_REG8(0xFFD9)
#define SCI0_SCR KZ_REG8(0xFFDA)
#define SCR_TIE 0x80
#define SCR_RIE 0x40
#define SCR_TE 0x20
#define SCR_RE 0x10
#define SCR_TEIE 0x04
#define SCI0_TDR KZ_REG8(0xFFDB)
#define SCI0_SSR KZ_REG8(0xFFDC)
#define SSR_TDRE 0x80
#define SSR_RDRF 0x40
#define SSR_ORER 0x20
#define SSR_FER 0x10
#define SSR_PER 0x08
#define SSR_TEND 0x04
#define SCI0_RDR KZ_REG8(0xFFDD)

// A/D converter. Results are in the upper 10 bits.
#define ADDRA KZ_REG16(0xFFE0)
#define ADDRB KZ_REG16(0xFFE2)
#define ADDRC KZ_REG16(0xFFE4)
#define ADDRD KZ_REG16(0xFFE6)
#define ADCSR KZ_REG8(0xFFE8)
#define ADCSR_ADF 0x80
#define ADCSR_ADIE 0x40
#define ADCSR_ADST 0x20
#define ADCSR_SCAN 0x10
#define ADCSR_AN0_TO_3 0x03

// Interrupts
#define KZ_INTERRUPTS_OFF() __asm__ volatile("orc #0x80,ccr" : : : "memory")
#define KZ_INTERRUPTS_ON() __asm__ volatile("andc #0x7f,ccr" : : : "memory")
// The chip takes no interrupt between the two instructions, so a pending interrupt ends the sleep at once.
#define KZ_INTERRUPTS_ON_AND_SLEEP() __asm__ volatile("andc #0x7f,ccr\n\tsleep" : : : "memory")
#define KZ_INTERRUPT __attribute__((interrupt_handler))

#endif
