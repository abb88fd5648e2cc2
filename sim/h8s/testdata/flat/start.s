; Start-up of programs on the flat machine: stack, main, exit; and what they ask of the host.
; SPDX-License-Identifier: Apache-2.0
; Built with -ms: int has 16 bits, pointers have 32.
        .h8300s
        .text
        .global _start, _write, _exit
_start: mov.l   #0xfffff0,er7
        jsr     @_main
        ; r0: status of main
_exit:  mov.b   r0l,r0h
        sub.b   r0l,r0l
        mov.w   #0xdead,r1
        mov.w   #0xbeef,r2
        sleep
        bra     _exit

; long write(long descriptor, const void *from, unsigned long length)
_write: jsr     @@0xc7:8
        rts

        .global ___main
___main:
        rts
