/* Bytes of a frame that are others: each input is a list of places and of bits to turn. The check
 * in a process of its own refuses the file, or what is read from it is what was written. */
#include "fuzz_input.h"
#include "results/snapshot.h"
#include "whole_frame.h"

#include <fcntl.h>

static void turn(int descriptor, size_t size, struct fuzz_bytes *bytes)
{
    while (bytes->at < bytes->end) {
        off_t at = (off_t)(fuzz_next(bytes, 3) % size);
        uint8_t byte = 0, bits = (uint8_t)fuzz_next(bytes, 1);
        fuzz_expect(pread(descriptor, &byte, 1, at) == 1, "the frame can be read");
        byte ^= bits;
        fuzz_expect(pwrite(descriptor, &byte, 1, at) == 1, "the frame can be written");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    size_t frame_size = whole_frame_put();
    struct fuzz_bytes bytes = {data, data + size};
    int descriptor = open(whole_frame_path(), O_RDWR);
    fuzz_expect(descriptor >= 0, "the frame can be opened");
    turn(descriptor, frame_size, &bytes);
    close(descriptor);
    char *wrong = snapshot_check(NULL, whole_frame_path());
    if (!wrong) whole_frame_expect();
    free(wrong);
    return 0;
}
