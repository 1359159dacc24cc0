// Known answers of FIPS 180 (NIST's examples), and lengths around a block's end.
#include "sha256.h"
#include "unity.h"

#include <string.h>

static uint8_t many[1000000];

void setUp(void) {}
void tearDown(void) {}

static void expect(const char *hex, const uint8_t *bytes, uint32_t size) {
    static const char digits[] = "0123456789abcdef";
    uint8_t digest[SHA256_BYTES];
    char text[2u * SHA256_BYTES + 1u] = "";
    sha256(bytes, size, digest);
    for (uint32_t i = 0; i < SHA256_BYTES; i++) {
        text[2u * i] = digits[digest[i] >> 4];
        text[2u * i + 1u] = digits[digest[i] & 15u];
    }
    TEST_ASSERT_EQUAL_STRING(hex, text);
}

static void test_known_texts(void) {
    static const char two[] = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
    expect("e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855", many, 0);
    expect("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
           (const uint8_t *)"abc", 3);
    expect("248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1", (const uint8_t *)two,
           sizeof two - 1u);
}

static void test_a_million_letters(void) {
    memset(many, 'a', sizeof many);
    expect("cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0", many, sizeof many);
}

// The length no longer fits behind 55 bytes: made by Python's hashlib.
static void test_lengths_around_a_block(void) {
    memset(many, 'a', 120);
    expect("9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318", many, 55);
    expect("b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a", many, 56);
    expect("7d3e74a05d7db15bce4ad9ec0658ea98e3f06eeecf16b4c6fff2da457ddc2f34", many, 63);
    expect("ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb", many, 64);
    expect("635361c48bb9eab14198e76ea8ab7f1a41685d6ad62aa9146d301d4f17eb0ae0", many, 65);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_known_texts);
    RUN_TEST(test_a_million_letters);
    RUN_TEST(test_lengths_around_a_block);
    return UNITY_END();
}
