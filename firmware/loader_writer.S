; The flash writer as the loader keeps it, to be copied to RAM.
; SPDX-License-Identifier: Apache-2.0
	.h8300s
	.section .lconst,"r"
	.align	1
	.global _kz_loader_writer
	.global _kz_loader_writer_end
_kz_loader_writer:
	.incbin	"writer.bin"
_kz_loader_writer_end:
