// wide: how the passes with a thread a contact get at what passes before them have written. contact_alone.comp is the other way.

#define ITERATE(i) FETCH(predicted, i)
#define LISTED(kind, place) FETCH_UINT(contact_list, first_place(kind) + place)
