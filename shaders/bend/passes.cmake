weft_passes(bend bend_gather bend_lambda)
