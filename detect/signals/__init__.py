"""Operations on any signal: smoothing, filters, order, gaps, crossings, surrogates."""
