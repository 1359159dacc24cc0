// Executes an undefined instruction: the fault handler must report it and end the image.
int main(void) {
    __asm__ volatile(".global undefined_here\nundefined_here: udf #0");
    return 0;
}
