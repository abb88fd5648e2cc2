; Start-up of the guest programs: stack, call of main, then sleep for good.
; SPDX-License-Identifier: Apache-2.0
        .h8300s
        .section .vect,"x"
        .long   _start
        .text
        .global _start
_start: mov.l   #0xfff000,er7
        jsr     @_main
        .global _done
_done:  sleep
        bra     _done
