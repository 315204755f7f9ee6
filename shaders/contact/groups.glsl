// groups: the arguments of an indirect dispatch over so many threads, of a pass that is not alone.

Groups groups_of(uint threads) { return Groups((threads + contact_settings.workgroup - 1) / contact_settings.workgroup, 1, 1); }
