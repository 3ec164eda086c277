/* The memory of contacts (histories and state bits), written to frames and read back. Contacts are
 * named by element ids and wall primitives alone, so that any rank can take them over. */
#ifndef DEMOCLES_PARTICLE_CONTACTS_H
#define DEMOCLES_PARTICLE_CONTACTS_H

#include "particle.h"
#include "results/sheet.h"

/* Columns of the contacts that remember something, and how many they are: state bits, history,
 * losses that no sum has yet. */
int64_t particle_contacts_sheet(struct sim *s, struct sheet *sheet, bool wall);
/* Back into the lists of now, from the frame s->from. owner [n_first]: rank of each element.
 * Collective. */
void particle_contacts_restore(struct sim *s, const int32_t *owner, bool wall);

#endif
