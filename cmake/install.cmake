# filled by the install issue
