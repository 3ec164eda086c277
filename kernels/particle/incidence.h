/* The list from which the gather adds up: for each owned element its pairs in ascending id of the
 * partner, as 2 * pair + is_down, where is_down says that the element is the higher id of the pair.
 * Rows are filled up to a multiple of INCIDENCE_ALIGN with a blank pair, whose result is zero. */
#ifndef DEMOCLES_INCIDENCE_H
#define DEMOCLES_INCIDENCE_H

#define INCIDENCE_ALIGN 8

#endif
