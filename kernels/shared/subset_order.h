// Where VPL k of N stands when the VPLs are dealt out to the `subsets` sub-images of an interleaved
// gather. Subset s holds a contiguous run of slots, so that one work-item walks it linearly.
//
// A Hammersley set's index carries u in its high bits and v (the radical inverse) in its low bits.
// Dealing by the *middle* bits leaves every subset stratified in both; dealing by the low bits
// (k mod subsets) would confine each subset to one narrow stripe of v, by the high bits to one of u.
#ifndef LW_SUBSET_ORDER_H
#define LW_SUBSET_ORDER_H

#include "portable.h"

typedef struct {
    lw_int subsets;   // n * n
    lw_int step;      // consecutive k that go to one subset
    lw_int capacity;  // slots of a subset; those that no k fills carry no flux
    lw_int count;     // N
} lw_subset_order;
LW_SIZE_CHECK(lw_subset_order, 16);

// Slots are visited instead of indices: returns k of a slot, or -1 for a slot that stays empty.
LW_FN lw_int lw_subset_index(lw_subset_order order, lw_int slot) {
    const lw_int subset = slot / order.capacity, place = slot % order.capacity;
    const lw_int k = (place / order.step) * order.step * order.subsets + subset * order.step + place % order.step;
    return k < order.count ? k : -1;
}

// The slot of k.
LW_FN lw_int lw_subset_slot(lw_subset_order order, lw_int k) {
    const lw_int run = k / order.step, place = (run / order.subsets) * order.step + k % order.step;
    return (run % order.subsets) * order.capacity + place;
}

#endif
