// What the pass pixel_repair and its kernels share.
#ifndef LW_PIXEL_REPAIR_TYPES_H
#define LW_PIXEL_REPAIR_TYPES_H

// Ints of its state: pixels that were marked, those of them that there was room for, and the others.
#define LW_REPAIR_MARKED 0
#define LW_REPAIR_TAKEN 1
#define LW_REPAIR_LEFT 2
#define LW_REPAIR_WORDS 3

// Columns of the image that they are put into. A tile of a gather then holds pixels that lay near each other; fewer columns: gathers
// of wide vectors leave most of a group idle.
#define LW_REPAIR_COLUMNS 128

// Marks: words of the bits of so many pixels of a row, as a work-item of an up-sampling has them, lowest bit first; none beyond the row.
#define LW_REPAIR_BITS (2 * LW_WIDTH)
#define LW_REPAIR_WORDS_OF_ROW(width) (((width) + LW_REPAIR_BITS - 1) / LW_REPAIR_BITS)

// A pixel as one int: sides are 16384 at most.
#define LW_REPAIR_PIXEL(x, y) ((y) << 16 | (x))
#define LW_REPAIR_X(pixel) ((pixel) & 0xffff)
#define LW_REPAIR_Y(pixel) ((pixel) >> 16)

#endif
