// Rows of pixels of one work-item of interleaved_gather_filter, which loads each of its window's rows once for all of
// them. The kernel is written for two; with four their sums and surfaces would not fit the registers.
#ifndef LW_FILTER_ROWS_H
#define LW_FILTER_ROWS_H

#define LW_FILTER_ROWS 2

#endif
