// groups: the arguments of an indirect dispatch over so many threads, of a pass that is not alone.

Groups groups_of_width(uint threads, uint width) { return Groups((threads + width - 1) / width, 1, 1); }

Groups groups_of(uint threads) { return groups_of_width(threads, contact_settings.workgroup); }
Groups thin_groups_of(uint threads) { return groups_of_width(threads, contact_settings.thin_workgroup); }
