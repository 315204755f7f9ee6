// groups: the arguments of an indirect dispatch over so many threads.

Groups groups_of(uint threads) { return Groups((threads + gl_WorkGroupSize.x - 1) / gl_WorkGroupSize.x, 1, 1); }
