"""The virtual machine that the Linux controller is tested in: an arm64 real-time kernel in QEMU.

`boots` runs the four boots, `measure` sums them up in figures; the rest builds the machine's
memory file system (initramfs, kernel_modules, libraries, cpio), runs it (machine, qmp) and reads
what the guest prints (results). docs/develop/virtual-machine.md says what is shown and what is not.
"""
