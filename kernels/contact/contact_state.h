/* Bits of a contact's state, an int: contact_history.state, and the array `state` of contacts. */
#ifndef DEMOCLES_CONTACT_STATE_H
#define DEMOCLES_CONTACT_STATE_H

#define CONTACT_TOUCHING 1
#define CONTACT_BONDED 2

#endif
